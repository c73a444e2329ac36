// Bundles the page and writes it as a C file: node build.mjs OUTPUT.c
import { build } from 'esbuild';
import { readFileSync, writeFileSync, renameSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const folder = dirname(fileURLToPath(import.meta.url));

async function bundle(entry, loader) {
  const result = await build({
    absWorkingDir: folder, entryPoints: [entry], bundle: true, minify: true, write: false, format: 'iife', target: 'es2020',
    legalComments: 'inline', charset: 'ascii', loader,
  });
  return result.outputFiles[0].text;
}

const script = (await bundle('main.js')).replaceAll('</script', '<\\/script');
const style = await bundle('style.css');
const html = readFileSync(join(folder, 'page.html'), 'utf8')
  .replace('/*STYLE*/', () => style)
  .replace('/*SCRIPT*/', () => script);

const bytes = Buffer.from(html, 'utf8');
const rows = [];
for (let i = 0; i < bytes.length; i += 40) rows.push([...bytes.subarray(i, i + 40)].map((b) => (b > 127 ? b - 256 : b)).join(','));
const c = `#include "view/page.h"\nconst char shv_view_page[] = {\n${rows.join(',\n')},0};\nconst size_t shv_view_page_size = ${bytes.length};\n`;
writeFileSync(process.argv[2] + '.part', c);
renameSync(process.argv[2] + '.part', process.argv[2]);
