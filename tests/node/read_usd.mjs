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
const name = process.argv[2].endsWith('z') ? 'room.usdz' : 'room.usda';
const parsed = layer.loadAsLayerFromBinary(bytes, name);
const text = parsed ? layer.layerToString() : '';
const scene = new native.TinyUSDZLoaderNative();
const loaded = scene.loadFromBinary(bytes, name);
const meshes = [];
for (let i = 0; loaded && i < scene.numMeshes(); ++i) {
  const mesh = scene.getMesh(i);
  const found = { name: mesh.absPath ?? mesh.primName, points: mesh.points.length / 3, indices: mesh.faceVertexIndices.length };
  if (mesh.materialId >= 0) {
    const texture = scene.getMaterial(mesh.materialId).emissiveColorTextureId;
    const image = scene.getImage(scene.getTexture(texture).textureImageId);
    found.image = { uri: image.uri, bytes: image.data.length };
  }
  meshes.push(found);
}
console.log(JSON.stringify({ parsed, loaded, text, meshes, error: layer.error() + scene.error() }));
