// KaTeX sets the formulas: formulas.js
