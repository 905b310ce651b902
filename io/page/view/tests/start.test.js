// The script in page.html that unpacks the program and starts it.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { runInNewContext } from "node:vm";
import { gzipSync } from "node:zlib";

const page = readFileSync(new URL("../page.html", import.meta.url), "utf8");
const script = page.match(/<script\{nonce\}>([\s\S]*?)<\/script>/)[1];

/** Runs the script in a page whose browser has this language; `start` is what an appended script does. */
async function open(language, start) {
  const navigator = Object.create({
    get language() {
      return language;
    },
  });
  const message = { hidden: false, textContent: "Loading" };
  const program = { textContent: gzipSync("the program").toString("base64") };
  const listeners = {};
  let appended = "";
  await new Promise((done) => {
    const document = {
      currentScript: { nonce: "" },
      getElementById: (id) => ({ message, program })[id],
      createElement: () => ({}),
      body: {
        append(element) {
          appended = element.textContent;
          try {
            start?.(navigator);
          } catch (error) {
            listeners.error({ message: `Uncaught ${error}` });
          }
          done();
        },
      },
    };
    const addEventListener = (name, listener) => (listeners[name] = listener);
    const browser = { document, navigator, addEventListener, atob, Blob, DecompressionStream, Response, Uint8Array };
    runInNewContext(script, browser);
  });
  return { navigator, message, appended };
}

test("a language that number formats refuse becomes English", async () => {
  assert.throws(() => new Intl.NumberFormat("en-US@posix"), RangeError);
  const { navigator, appended } = await open("en-US@posix", (it) => new Intl.NumberFormat(it.language));
  assert.equal(navigator.language, "en");
  assert.equal(appended, "the program");
});

test("a language that number formats know stays", async () => {
  const { navigator } = await open("de-AT");
  assert.equal(navigator.language, "de-AT");
});

test("an error at the start is shown", async () => {
  const { message } = await open("en", () => {
    throw new Error("no canvas");
  });
  assert.equal(message.textContent, "The page cannot be shown: Uncaught Error: no canvas");
});
