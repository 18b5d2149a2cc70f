// Formulas as \( \) and \[ \], which is how the pages hold them, set by KaTeX.
document.addEventListener("DOMContentLoaded", () =>
    renderMathInElement(document.body, {
        delimiters: [
            {left: "\\(", right: "\\)", display: false},
            {left: "\\[", right: "\\]", display: true},
        ],
    }));
