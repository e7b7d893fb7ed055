/** @file Rows of CSV as cells; quoted ones may hold commas, quotes and lines. */

/** @param {string} text @returns {string[][]} */
export function parse(text) {
  if (!text.includes('"')) return text.trimEnd().split('\n').map((line) => line.split(','));
  const rows = [[]];
  let i = 0;
  while (i < text.length) {
    let cell;
    if (text[i] === '"') {
      let from = i + 1;
      cell = '';
      for (;;) {
        const to = text.indexOf('"', from);
        if (to < 0) throw new Error('a quote is not closed');
        cell += text.slice(from, to);
        i = to + 1;
        if (text[i] !== '"') break;
        cell += '"';
        from = i + 1;
      }
    } else {
      const from = i;
      while (i < text.length && text[i] !== ',' && text[i] !== '\n') i++;
      cell = text.slice(from, i);
    }
    rows[rows.length - 1].push(cell);
    if (text[i] === '\n' && i + 1 < text.length) rows.push([]);
    i++;
  }
  return rows;
}
