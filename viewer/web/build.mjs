// Bundles src/ into template HTMLs, for runs, for diagrams and for scenes that run: styles and script inlined, nothing
// fetched when they are opened.
// Usage: node build.mjs [run.html [charts.html [live.html]]]
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const pages = [
  { entry: 'src/main.js', libraries: ['three', 'uplot'], output: resolve(process.argv[2] ?? join(here, 'template.html')) },
  { entry: 'src/charts.js', libraries: ['uplot'], output: resolve(process.argv[3] ?? join(here, 'charts.html')) },
  { entry: 'src/live/main.js', libraries: ['three', 'uplot'], output: resolve(process.argv[4] ?? join(here, 'live.html')) },
];

for (const { entry, libraries, output } of pages) {
  const bundled = await build({
    entryPoints: [join(here, entry)],
    bundle: true,
    minify: true,
    write: false,
    outdir: here,
    format: 'iife',
    target: 'es2020',
    legalComments: 'none', // named in THIRD_PARTY below: esbuild would repeat whole licenses per module
    loader: { '.glsl': 'text' },
  });
  const text = (ending) => bundled.outputFiles.find((file) => file.path.endsWith(ending)).text;

  // The licenses of the bundled libraries ask that their notice travels with every copy.
  const licenses = libraries
    .map((name) => `${name}\n\n${readFileSync(join(here, 'node_modules', name, 'LICENSE'), 'utf8').trim()}`)
    .join('\n\n')
    .replaceAll('--', '- -');

  // Function replacements: a "$&" inside the bundle must not be read as a replacement pattern.
  const html = readFileSync(join(here, 'src/template.html'), 'utf8')
    .replace('/*STYLE*/', () => text('.css').replaceAll('</style', '<\\/style'))
    .replace('/*SCRIPT*/', () => text('.js').replaceAll('</script', '<\\/script'))
    .replace('THIRD_PARTY', () => licenses);
  for (const marker of ['<!--ISOCHOR-TITLE-->', '<!--ISOCHOR-DATA-->']) {
    if (html.split(marker).length !== 2) throw new Error(`template.html must hold ${marker} exactly once`);
  }
  writeFileSync(output, html);
}
