// A way of the camera through key frames, as src/scene/camera_path.h has it, and its file for `aligngs render --path`.
export interface CameraKey { time: number; eye: number[]; target: number[]; fov: number } // seconds; the scene's own axes; degrees

const kFormat = 'aligngs camera path', kVersion = 1, kMostKeys = 1000, kLongest = 3600, kFov = 62;
const kSame = 1e-9;

const values = (k: CameraKey): number[] => [...k.eye, ...k.target, k.fov];
const keyOf = (time: number, v: number[]): CameraKey => ({ time, eye: v.slice(0, 3), target: v.slice(3, 6), fov: v[6] });

/// The camera at a time, by cubic Hermite curves through the keys; the first and the last key hold before and after.
export function keyAt(keys: CameraKey[], time: number): CameraKey {
  const last = keys.length - 1;
  if (time <= keys[0].time) return keys[0];
  if (time >= keys[last].time) return keys[last];
  const i = keys.findIndex((k) => k.time > time) - 1, all = keys.map(values);
  const span = (k: number) => keys[k + 1].time - keys[k].time;
  const slope = (k: number, c: number) => (all[k + 1][c] - all[k][c]) / span(k);
  const loop = last > 1 && all[0].every((v, c) => Math.abs(v - all[last][c]) <= kSame);
  const tangent = (k: number, c: number) => {
    if (!loop && k === 0) return slope(0, c);
    if (!loop && k === last) return slope(last - 1, c);
    const before = k === 0 ? last - 1 : k - 1, after = k === last ? 0 : k;
    return (slope(before, c) * span(after) + slope(after, c) * span(before)) / (span(before) + span(after));
  };
  const s = (time - keys[i].time) / span(i);
  const h00 = (1 + 2 * s) * (1 - s) ** 2, h10 = s * (1 - s) ** 2, h01 = s * s * (3 - 2 * s), h11 = s * s * (s - 1);
  return keyOf(time, all[i].map((a, c) => h00 * a + h10 * span(i) * tangent(i, c) + h01 * all[i + 1][c] + h11 * span(i) * tangent(i + 1, c)));
}

export const duration = (keys: CameraKey[]): number => (keys.length > 1 ? keys[keys.length - 1].time - keys[0].time : 0);

/// The same way in `seconds`, from time 0.
export function stretched(keys: CameraKey[], seconds: number): CameraKey[] {
  const factor = duration(keys) > 0 ? seconds / duration(keys) : 1;
  return keys.map((k) => ({ ...k, time: (k.time - keys[0].time) * factor }));
}

export const pathText = (keys: CameraKey[]): string => JSON.stringify({ format: kFormat, version: kVersion, keys }, null, 2) + '\n';

/// The keys of a file; an Error that names what is wrong.
export function readPath(text: string): CameraKey[] {
  let json: { format?: unknown; version?: unknown; keys?: unknown };
  try { json = JSON.parse(text); } catch { throw new Error('The file is no JSON.'); }
  if (json?.format !== kFormat || json.version !== kVersion) throw new Error('The file holds no key frames of this program.');
  const keys = json.keys;
  if (!Array.isArray(keys) || keys.length < 1 || keys.length > kMostKeys) throw new Error('A path has 1 to 1000 keys.');
  const place = (v: unknown): v is number[] => Array.isArray(v) && v.length === 3 && v.every((x) => Number.isFinite(x));
  return keys.map((k, i) => {
    const { time, eye, target, fov = kFov } = (k ?? {}) as Partial<CameraKey>;
    if (!Number.isFinite(time) || time! < 0 || time! > kLongest || (i > 0 && !(time! > keys[i - 1].time))) throw new Error(`The time of key ${i + 1} is wrong.`);
    if (!place(eye) || !place(target)) throw new Error(`The place of key ${i + 1} is wrong.`);
    if (!Number.isFinite(fov) || fov < 5 || fov > 150) throw new Error(`The field of view of key ${i + 1} is wrong.`);
    return { time: time!, eye, target, fov };
  });
}
