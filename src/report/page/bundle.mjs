// Makes template.html from the sources in this folder; with --check, verifies that it is up to date.
//
// The template carries the hash of its sources, so that a test without Node can notice a stale
// bundle; README.md has the recipe.
import { createHash } from 'node:crypto';
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = dirname(fileURLToPath(import.meta.url));
const read = (name) => readFileSync(join(folder, name));

// The files that determine the bundle, in the order of `LC_ALL=C ls`.
function sourceNames() {
  const scripts = readdirSync(join(folder, 'src')).filter((name) => name.endsWith('.js')).sort();
  return ['LICENSES.txt', 'bundle.mjs', 'package-lock.json', 'package.json', 'page.css', 'page.html',
          ...scripts.map((name) => `src/${name}`)];
}

// The same as `sha256sum FILES | sha256sum`.
function sourceHash() {
  const hash = (bytes) => createHash('sha256').update(bytes).digest('hex');
  return hash(sourceNames().map((name) => `${hash(read(name))}  ${name}\n`).join(''));
}

async function makeTemplate() {
  const esbuild = await import('esbuild');
  const bundle = async (entry) => {
    const result = await esbuild.build({
      absWorkingDir: folder, entryPoints: [entry], bundle: true, minify: true, write: false,
      format: 'iife', target: 'es2022', legalComments: 'none', charset: 'utf8',
    });
    return result.outputFiles[0].text.trim();
  };
  // Inside a script element, only this sequence could end it.
  const script = (await bundle('src/main.js')).replaceAll(/<\/script/gi, '<\\/script');
  const style = (await bundle('page.css')).replaceAll(/<\/style/gi, '<\\/style');
  const scriptHash = createHash('sha256').update(script).digest('base64');
  const parts = {
    SCRIPT_HASH: `'sha256-${scriptHash}'`,
    SOURCE_HASH: sourceHash(),
    LICENCES: `<!--\n${read('LICENSES.txt').toString().trim().replaceAll('--', '- -')}\n-->`,
    STYLE: style,
    SCRIPT: script,
  };
  const template = read('page.html').toString().replaceAll(/\{\{(\w+)\}\}/g, (_, name) => parts[name]);
  const placeholder = '\n<script type="application/json" id="report-data">{}</script>\n';
  if (template.split(placeholder).length !== 2) throw new Error('the placeholder must occur exactly once');
  return template;
}

if (process.argv.includes('--check')) {
  const found = /name="source-sha256" content="([0-9a-f]*)"/.exec(read('template.html').toString())?.[1];
  if (found !== sourceHash()) {
    console.error('template.html does not belong to these sources: run `npm run bundle`.');
    process.exit(1);
  }
} else {
  const template = await makeTemplate();
  writeFileSync(join(folder, 'template.html'), template);
  console.log(`template.html: ${(template.length / 1e3).toFixed(0)} kB`);
}
