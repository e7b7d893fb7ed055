/** @file Small helpers to build the page. Text from the data only ever enters as text nodes. */

/**
 * Makes an element. Properties starting with "on" are listeners, "class", "text", "aria-*", "data-*" and "role" are set as such.
 * @param {string} tag
 * @param {Record<string, any>} [props]
 * @param {...(Node|string|null|undefined|false)} children
 * @returns {any}
 */
export function h(tag, props = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value == null || value === false) continue;
    if (key === 'class') node.className = value;
    else if (key === 'text') node.textContent = value;
    else if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key in node && !key.startsWith('aria')) node[key] = value;
    else node.setAttribute(key, value === true ? '' : String(value));
  }
  for (const child of children) if (child) node.append(child);
  return node;
}

/** @param {string} id @returns {any} */
export const byId = (id) => document.getElementById(id);

/** Long names would make tooltips as long: titles are cut. @param {string} text */
export const title = (text) => (text.length > 200 ? `${text.slice(0, 199)}…` : text);

/** Sets the text of a node only when it changes, which spares layouts. @param {Node} node @param {string} text */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Empties a node and fills it. @param {Element} node @param {...Node} children */
export const fill = (node, ...children) => node.replaceChildren(...children);
