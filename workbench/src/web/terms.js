// Terms of the glossary with their meaning as a tooltip.

import { element } from "./dom.js";

const MEANINGS = {
  "noise floor": "Scatter (σ) of a measurement, estimated without the model. An error of 1 × noise is that of a perfect model.",
  "excess error": "Squared residual beyond the noise floor.",
  Evidence: "Schwarz criterion (BIC) without the effect minus that with it, corrected for correlated errors.",
};

/** Returns a term with its meaning; `text` is shown in place of the term. */
export const term = (name, text = name) => element("abbr", { title: MEANINGS[name], tabIndex: 0 }, text);
