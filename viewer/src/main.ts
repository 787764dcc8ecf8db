/**
 * Starts the page. The page itself is a module of its own: whatever it throws while it is read or made is shown,
 * with what to do, in place of "Palpate is starting". Its texts are there before it is read.
 */
import { ensureLanguage } from "./ui/app/browser_language";
import { showFailure, watchStart } from "./ui/app/start_failure";
import { loadLanguage } from "./texts/page.loader";
import "./ui/theme/theme.css";

const host = document.getElementById("app");
if (host === null) {
  throw new Error("the page has lost its frame: no #app in index.html");
}
const started = watchStart(host);
try {
  ensureLanguage();
  // one that is asked for in the address goes before the browser's
  const asked = new URLSearchParams(window.location.search).getAll("language");
  document.documentElement.lang = await loadLanguage([...asked, ...navigator.languages]);
  const [{ mount }, { default: App }] = await Promise.all([import("svelte"), import("./ui/app/App.svelte")]);
  host.replaceChildren();
  mount(App, { target: host, props: { started } });
} catch (error) {
  showFailure(host, error);
}
