// Typesets the formulas of the book as MathML, which browsers draw by themselves: nothing is fetched, on the disk or from a server.
//
// Pages hold TeX as GitHub and GitLab read it, blocks ```math and spans $`…`$, of the words below and no others
// (crates/springpot-cli/tests/book/math.rs looks at every formula). What this file cannot read stays as it was written.
'use strict';

const SYMBOLS = {
    alpha: 'α', beta: 'β', gamma: 'γ', delta: 'δ', epsilon: 'ε', eta: 'η', theta: 'θ', lambda: 'λ', mu: 'μ', nu: 'ν', xi: 'ξ', pi: 'π',
    rho: 'ρ', sigma: 'σ', tau: 'τ', phi: 'φ', psi: 'ψ', omega: 'ω', Gamma: 'Γ', Delta: 'Δ', Pi: 'Π', Sigma: 'Σ', Omega: 'Ω',
    infty: '∞', partial: '∂',
};
const OPERATORS = {
    cdot: '·', times: '×', le: '≤', ge: '≥', ne: '≠', approx: '≈', ll: '≪', gg: '≫', in: '∈', to: '→', gets: '←', oplus: '⊕',
    ominus: '⊖', pm: '±', dots: '…', lvert: '|', rvert: '|', lceil: '⌈', rceil: '⌉',
};
const SPACES = { ',': 0.17, ';': 0.28, quad: 1, qquad: 2 };
const LARGE = { sum: '∑', int: '∫', prod: '∏' };
const FUNCTIONS = ['sin', 'cos', 'tan', 'arctan', 'exp', 'log', 'ln', 'tanh', 'max', 'min', 'det'];
const ACCENTS = { dot: '˙', ddot: '¨', bar: '¯', hat: '^', tilde: '~', vec: '→' };

const tag = (name, inner, attributes = '') => `<${name}${attributes}>${inner}</${name}>`;
const escaped = text => text.replace(/&/g, '&amp;').replace(/</g, '&lt;').replace(/>/g, '&gt;');
const row = parts => (parts.length === 1 ? parts[0] : tag('mrow', parts.join('')));

class Formula {
    constructor(text) {
        this.words = text.match(/\\[a-zA-Z]+|\\.|\d+(?:\.\d+)?|\s+|[^\s]/gu) ?? [];
        this.at = 0;
    }

    next() {
        while (/^\s+$/.test(this.words[this.at] ?? '')) this.at += 1;
        return this.words[this.at];
    }

    // Whether an operand begins here: nothing stands before it, or something that opens or relates.
    begins() {
        let at = this.at - 1;
        while (/^\s+$/.test(this.words[at] ?? '')) at -= 1;
        const word = this.words[at];
        return word === undefined || /^[({[=+\-,<>]$/.test(word) || word === '\\left' || word.slice(1) in OPERATORS || word.slice(1) in SPACES;
    }

    // The name of a function, with room where an operand stands beside it.
    named(name, begins) {
        const room = [!begins, !/^[({]$|^\\left$/.test(this.next() ?? '')].map(wide => (wide ? '0.167em' : '0'));
        return tag('mo', name, ` form="prefix" lspace="${room[0]}" rspace="${room[1]}"`);
    }

    take(word) {
        if (this.next() !== word) throw new Error(`${word} is missing`);
        this.at += 1;
    }

    // All up to a word that ends it.
    parts(end) {
        const found = [];
        while (this.next() !== end) {
            if (this.next() === undefined) throw new Error(`${end} is missing`);
            found.push(this.scripted());
        }
        return found;
    }

    group() {
        if (this.next() !== '{') return this.atom().inner;
        this.take('{');
        const inner = row(this.parts('}'));
        this.take('}');
        return inner;
    }

    // The letters of a group as they stand.
    text() {
        this.take('{');
        const end = this.words.indexOf('}', this.at);
        const words = this.words.slice(this.at, end).join('');
        this.at = end + 1;
        return escaped(words);
    }

    scripted() {
        const { inner, limits } = this.atom();
        let below, above, primes = '';
        for (;;) {
            const word = this.next();
            if (!['_', '^', "'"].includes(word)) break;
            this.at += 1;
            if (word === '_') below = this.group();
            else if (word === '^') above = this.group();
            else primes += tag('mo', '′', ' lspace="0" rspace="0"');
        }
        // A prime stands raised by itself. Beside an index it comes last, under a power first.
        const base = primes && above ? tag('mrow', inner + primes) : inner;
        const whole = this.raised(base, below, above, limits);
        return primes && !above ? tag('mrow', whole + primes) : whole;
    }

    raised(inner, below, above, limits) {
        const kind = limits ? ['munder', 'mover', 'munderover'] : ['msub', 'msup', 'msubsup'];
        if (below && above) return tag(kind[2], inner + below + above);
        if (below) return tag(kind[0], inner + below);
        return above ? tag(kind[1], inner + above) : inner;
    }

    atom() {
        const word = this.next();
        if (word === '{') return { inner: this.group() };
        const begins = this.begins();
        this.at += 1;
        const name = word.startsWith('\\') ? word.slice(1) : '';
        if (name === 'frac') return { inner: tag('mfrac', this.group() + this.group()) };
        if (name === 'sqrt') return { inner: tag('msqrt', this.group()) };
        if (name === 'text') return { inner: tag('mtext', this.text()) };
        if (name === 'operatorname') return { inner: this.named(this.text(), begins) };
        if (name === 'left') {
            const open = this.next();
            this.at += 1;
            const inner = this.parts('\\right');
            this.take('\\right');
            const close = this.next();
            this.at += 1;
            const fence = mark => tag('mo', OPERATORS[mark.slice(1)] ?? escaped(mark), ' stretchy="true"');
            return { inner: tag('mrow', fence(open) + inner.join('') + fence(close)) };
        }
        if (name in ACCENTS) return { inner: tag('mover', this.group() + tag('mo', ACCENTS[name], ' stretchy="false"'), ' accent="true"') };
        if (name in LARGE) return { inner: tag('mo', LARGE[name]), limits: name !== 'int' };
        if (FUNCTIONS.includes(name)) return { inner: this.named(name, begins) };
        if (name in SYMBOLS) return { inner: tag('mi', SYMBOLS[name], /[A-ZΓΔΠΣΩ∞]/u.test(SYMBOLS[name]) ? ' mathvariant="normal"' : '') };
        if (name in SPACES) return { inner: tag('mspace', '', ` width="${SPACES[name]}em"`) };
        const fence = { l: 'prefix', r: 'postfix' }[/^([lr])(vert|ceil)$/.exec(name)?.[1]];
        if (name in OPERATORS) return { inner: tag('mo', OPERATORS[name], fence ? ` form="${fence}" stretchy="false"` : '') };
        if (name) throw new Error(`\\${name} is not known`);
        if (/^\d/.test(word)) return { inner: tag('mn', word) };
        if (/^\p{L}$/u.test(word)) return { inner: tag('mi', word) };
        if (/^[()[\]/]$/.test(word)) return { inner: tag('mo', word, ' stretchy="false"') };
        if (word === '-') return { inner: tag('mo', '−', begins ? ' form="prefix"' : '') };
        return { inner: tag('mo', escaped(word)) };
    }

    mathml(display) {
        const inner = row(this.parts(undefined));
        return tag('math', inner, ` xmlns="http://www.w3.org/1998/Math/MathML" display="${display}"`);
    }
}

const typeset = (tex, display) => new Formula(tex.trim()).mathml(display);

if (typeof document !== 'undefined') {
    const attempt = (tex, display, put) => {
        try {
            put(typeset(tex, display));
        } catch (error) {
            console.warn(`${tex}: ${error.message}`);
        }
    };
    for (const code of document.querySelectorAll('code.language-math')) {
        attempt(code.textContent, 'block', html => { code.closest('pre').outerHTML = `<div class="formula">${html}</div>`; });
    }
    for (const code of document.querySelectorAll('code')) {
        const [before, after] = [code.previousSibling, code.nextSibling];
        if (!before?.nodeValue?.endsWith('$') || !after?.nodeValue?.startsWith('$')) continue;
        attempt(code.textContent, 'inline', html => {
            before.nodeValue = before.nodeValue.slice(0, -1);
            after.nodeValue = after.nodeValue.slice(1);
            code.outerHTML = html;
        });
    }
} else {
    module.exports = { typeset };
}
