// Light and dark theme. The style sheet defines the colours; charts read them from there.

const KEY = "theme";

export const isDark = () => document.documentElement.dataset.theme === "dark";

/** Returns the colour of a role. */
export const colour = (role) => getComputedStyle(document.documentElement).getPropertyValue(`--${role}`).trim();

/** Sets the theme that was selected last, or the system's. */
export function begin(control, onChange) {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const show = (dark) => {
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    control.textContent = dark ? "Light" : "Dark";
    onChange();
  };
  const chosen = localStorage.getItem(KEY);
  show(chosen ? chosen === "dark" : system.matches);
  system.addEventListener("change", () => { if (!localStorage.getItem(KEY)) show(system.matches); });
  control.addEventListener("click", () => {
    localStorage.setItem(KEY, isDark() ? "light" : "dark");
    show(!isDark());
  });
}
