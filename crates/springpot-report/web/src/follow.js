/** @file A run that is still going on: rows come in as server-sent events. */

/** @param {any} app @param {string} address */
export function follow(app, address) {
  const source = new EventSource(address);
  source.onmessage = (event) => {
    let message;
    try {
      message = JSON.parse(event.data);
    } catch {
      app.fail('A message of the running simulation could not be read.');
      return;
    }
    if (message.cases) {
      const added = message.cases.map((raw) => app.data.addCase(raw)).filter(Boolean);
      if (added.length) app.grown(added);
    }
    if (message.rows) {
      const one = app.data.cases.find((each) => each.index === (message.case ?? 0));
      if (one) {
        one.append(message.rows);
        app.appended();
      }
    }
    if (message.status) {
      source.close();
      app.ended(message.status);
    }
  };
  source.onerror = () => {
    // The browser tries again by itself unless the server refused.
    if (source.readyState === EventSource.CLOSED) app.ended('interrupted');
  };
  return source;
}
