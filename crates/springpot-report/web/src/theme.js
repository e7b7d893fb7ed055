/** @file Light and dark. */

/** What the canvases need of the style sheet. @returns {Record<string, string>} */
export function palette() {
  const style = getComputedStyle(document.documentElement), out = {};
  for (const name of ['ink', 'soft', 'rule', 'zero', 'accent', 'panel', 'event']) out[name] = style.getPropertyValue(`--${name}`).trim();
  out.font = style.getPropertyValue('--font').trim() || 'sans-serif';
  return out;
}

/** What a reader chose before, if the browser remembers it for files. */
export function remembered() {
  try {
    return localStorage.getItem('springpot-theme');
  } catch {
    return null;
  }
}

/** @param {boolean} dark */
export function remember(dark) {
  try {
    localStorage.setItem('springpot-theme', dark ? 'dark' : 'light');
  } catch {
    // then it lasts as long as the page
  }
}
