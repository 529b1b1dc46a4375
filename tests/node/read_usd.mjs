// Prints what tinyusdz reads of a USD file as JSON: node read_usd.mjs FILE
import { readFile } from 'node:fs/promises';

// The package is built for browsers alone; its loader asks only these.
process.type = 'renderer';
globalThis.window = globalThis;
const { default: init } = await import('tinyusdz');
const wasm = await readFile(new URL(import.meta.resolve('tinyusdz/tinyusdz.wasm')));
const native = await init({ wasmBinary: wasm, print: () => {}, printErr: (m) => console.error(m) });
const bytes = new Uint8Array(await readFile(process.argv[2]));
const layer = new native.TinyUSDZLoaderNative();
const parsed = layer.loadAsLayerFromBinary(bytes, 'room.usda');
const text = parsed ? layer.layerToString() : '';
const scene = new native.TinyUSDZLoaderNative();
const loaded = scene.loadFromBinary(bytes, 'room.usda');
const meshes = [];
for (let i = 0; loaded && i < scene.numMeshes(); ++i) {
  const mesh = scene.getMesh(i);
  meshes.push({ name: mesh.absPath ?? mesh.primName, points: mesh.points.length / 3, indices: mesh.faceVertexIndices.length });
}
console.log(JSON.stringify({ parsed, loaded, text, meshes, error: layer.error() + scene.error() }));
