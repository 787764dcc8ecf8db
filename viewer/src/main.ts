/**
 * Starts the page.
 */
import { mount } from "svelte";
import App from "./ui/app/App.svelte";
import "./ui/theme/theme.css";

const host = document.getElementById("app");
if (host === null) {
  throw new Error("the page has lost its frame: no #app in index.html");
}
host.replaceChildren();
mount(App, { target: host });
