// Builds dist/view.js, dist/view.css and dist/LICENSES.txt. Run `.ci/bundle-view`, which calls this.
// With `--outdir DIR` the files are written there.

import { readFileSync, writeFileSync } from "node:fs";
import { parseArgs } from "node:util";
import { build } from "esbuild";

const { outdir } = parseArgs({ options: { outdir: { type: "string", default: "dist" } } }).values;
const { dependencies } = JSON.parse(readFileSync("package.json", "utf8"));
const licences = Object.entries(dependencies)
  .map(
    ([name, version]) =>
      `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}\n`,
  )
  .join("\n");

await build({
  entryPoints: { view: "src/main.js" },
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "ascii",
  outdir,
  // The licences are in the banner, and in a file of their own.
  legalComments: "none",
  banner: { js: `/*!\n${licences}*/`, css: "/*! Has the style of uPlot, MIT licence: see the program. */" },
});
writeFileSync(`${outdir}/LICENSES.txt`, licences);
