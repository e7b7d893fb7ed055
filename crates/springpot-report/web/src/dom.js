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
    else if (key === 'text') node.textContent = plain(String(value));
    else if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key in node && !key.startsWith('aria')) node[key] = value;
    else node.setAttribute(key, value === true ? '' : String(value));
  }
  for (const child of children) if (child) node.append(child);
  return node;
}

/** @param {string} id @returns {any} */
export const byId = (id) => document.getElementById(id);

const UNSEEN = /[\u0000-\u0008\u000b-\u001f\u007f-\u009f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]/g;

/** Control characters as their pictures, and what has no width or turns the direction of text as �: names cannot reorder or hide what stands beside them. @param {string} text */
export const plain = (text) => text.replace(UNSEEN, (c) => (c < ' ' ? String.fromCharCode(0x2400 + c.charCodeAt(0)) : '\ufffd'));

/** Long names would make tooltips as long: titles are cut. @param {string} text */
export const title = (text) => plain(text.length > 200 ? `${text.slice(0, 199)}…` : text);

/** Sets the text of a node only when it changes, which spares layouts. @param {Node} node @param {string} text */
export function setText(node, text) {
  const shown = plain(text);
  if (node.textContent !== shown) node.textContent = shown;
}

/** Empties a node and fills it. @param {Element} node @param {...Node} children */
export const fill = (node, ...children) => node.replaceChildren(...children);
