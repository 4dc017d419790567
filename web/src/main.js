// The program of the pages that brio writes: shows what is in the page.
import { App } from "./app.js";
import { at } from "./dom.js";

const app = window.brioPage = new App();
app.ready = app.start().catch(error => {
    at("status").className = "failed";
    app.say(error.message);
    throw error;
});
