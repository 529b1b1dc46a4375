// The object under the cursor: the largest response of each Gaussian along the ray, blended front to back.
export interface Splats {
  count: number; centres: Float32Array; scales: Float32Array; rotations: Float32Array; // rotations w x y z, scales in scene units
  opacities: Float32Array; labels: Uint16Array | null; instances: Uint16Array | null; confidences: Uint8Array | null;
  places: Int32Array | null; total: number; // as Columns has them
}
export const kLeastAlpha = 1 / 255; // fainter Gaussians are not drawn, alpha_min of the rasteriser
// Less than this of a ray is stopped: no click means such a haze. A seam between two surfaces stops more, if not half.
const kLeastOpacity = 0.1;
export interface Hit { label: number; share: number; instance: number; confidence: number; distance: number }

/// `origin`, `direction` (unit) in the splats' own frame. Splats that are not drawn let the ray through.
export function pickSplat(s: Splats, origin: number[], direction: number[], drawn: (splat: number) => boolean): Hit | null {
  const hits: { t: number; alpha: number; index: number }[] = [];
  const [dx, dy, dz] = direction;
  for (let i = 0; i < s.count; ++i) {
    const px = s.centres[3 * i] - origin[0], py = s.centres[3 * i + 1] - origin[1], pz = s.centres[3 * i + 2] - origin[2];
    const along = px * dx + py * dy + pz * dz;
    if (along <= 0.02) continue;
    const largest = 3 * Math.max(s.scales[3 * i], s.scales[3 * i + 1], s.scales[3 * i + 2]);
    if (px * px + py * py + pz * pz - along * along > largest * largest) continue;
    if (!drawn(i)) continue;
    const w = s.rotations[4 * i], x = s.rotations[4 * i + 1], y = s.rotations[4 * i + 2], z = s.rotations[4 * i + 3];
    // Rows of R^T: the Gaussian's axes.
    const axes = [
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
    ];
    let ee = 0, ge = 0, gg = 0;
    for (let k = 0; k < 3; ++k) {
      const inverse = 1 / Math.max(1e-9, s.scales[3 * i + k]);
      const g = (axes[k][0] * px + axes[k][1] * py + axes[k][2] * pz) * inverse;
      const e = (axes[k][0] * dx + axes[k][1] * dy + axes[k][2] * dz) * inverse;
      ee += e * e; ge += g * e; gg += g * g;
    }
    const distance2 = Math.max(0, gg - (ge * ge) / ee);
    if (distance2 > 9) continue;
    const alpha = s.opacities[i] * Math.exp(-0.5 * distance2);
    if (alpha > kLeastAlpha) hits.push({ t: ge / ee, alpha, index: i });
  }
  hits.sort((a, b) => a.t - b.t);
  const votes = new Map<number, { weight: number; index: number; best: number }>();
  let light = 1;
  const reached: { t: number; light: number }[] = [];
  for (const hit of hits) {
    const weight = light * hit.alpha, label = s.labels ? s.labels[hit.index] : 65535;
    const vote = votes.get(label) ?? { weight: 0, index: hit.index, best: 0 };
    vote.weight += weight;
    if (weight > vote.best) { vote.best = weight; vote.index = hit.index; }
    votes.set(label, vote);
    light *= 1 - hit.alpha;
    reached.push({ t: hit.t, light });
    if (light < 1e-3) break;
  }
  if (1 - light < kLeastOpacity) return null; // nothing to be seen there
  const distance = reached.find((r) => 1 - r.light >= 0.5 * (1 - light))!.t; // half of what stops the ray has stopped it
  const [label, vote] = [...votes].sort((a, b) => b[1].weight - a[1].weight)[0];
  return {
    label, share: vote.weight / (1 - light), distance,
    instance: s.instances ? s.instances[vote.index] : 0, confidence: s.confidences ? s.confidences[vote.index] / 255 : 0,
  };
}
