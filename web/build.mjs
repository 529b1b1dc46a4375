// Builds web/dist from web/src. The same sources and versions give the same bytes.
import { build } from 'esbuild';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

/// The page draws with WebGL 2 alone. PlayCanvas also carries its shaders and its device for WebGPU: a quarter of the script.
const withoutText = (module) => [...module.matchAll(/(\w+) as default|^\t(\w+Source),?$/gm)].map(([, , named]) => (named ? `export const ${named} = '';` : "export default '';")).join('\n');
const withoutWebgpu = {
  name: 'without-webgpu',
  setup({ onLoad }) {
    onLoad({ filter: /[\\/]shader-lib[\\/]wgsl[\\/]chunks[\\/].*\.js$/ }, ({ path }) => ({ contents: withoutText(readFileSync(path, 'utf8')) }));
    onLoad({ filter: /[\\/]webgpu-graphics-device\.js$/ }, () => ({ contents: 'export class WebgpuGraphicsDevice {}' }));
  },
};
const here = dirname(fileURLToPath(import.meta.url)), out = process.argv[2] ?? join(here, 'dist');
mkdirSync(out, { recursive: true });
for (const [source, script, format] of [['main', 'app', 'esm'], ['start', 'start', 'iife']]) {
  await build({
    entryPoints: [join(here, `src/${source}.ts`)], outfile: join(out, `${script}.js`), bundle: true, minify: true, format, target: 'es2021',
    plugins: [withoutWebgpu],
    legalComments: 'none', absWorkingDir: here, logLevel: 'warning',
  });
}
const styles = readFileSync(join(here, 'node_modules/uplot/dist/uPlot.min.css'), 'utf8') + readFileSync(join(here, 'src/app.css'), 'utf8');
writeFileSync(join(out, 'app.css'), styles);
for (const name of ['index.html', 'favicon.svg']) copyFileSync(join(here, 'src', name), join(out, name));
const licences = ['playcanvas', 'uplot'].map((name) => {
  const { version } = JSON.parse(readFileSync(join(here, 'node_modules', name, 'package.json'), 'utf8'));
  return `${name} ${version}\n\n${readFileSync(join(here, 'node_modules', name, 'LICENSE'), 'utf8')}`;
});
writeFileSync(join(out, 'third_party_licenses.txt'), licences.join('\n\n'));
