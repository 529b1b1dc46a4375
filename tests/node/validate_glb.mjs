// Prints what the Khronos validator says of a GLB file as JSON: node validate_glb.mjs FILE
import { readFile } from 'node:fs/promises';
import validator from 'gltf-validator';

const bytes = new Uint8Array(await readFile(process.argv[2]));
const report = await validator.validateBytes(bytes, { maxIssues: 100 });
// The validator does not know KHR_gaussian_splatting yet; attributes with its prefix are not errors of the file.
const known = (m) => !/KHR_gaussian_splatting/.test(`${m.message} ${m.pointer}`) && m.code !== 'UNSUPPORTED_EXTENSION';
const errors = report.issues.messages.filter((m) => m.severity === 0 && known(m));
const warnings = report.issues.messages.filter((m) => m.severity === 1 && known(m));
console.log(JSON.stringify({ errors, warnings, info: report.info }));
