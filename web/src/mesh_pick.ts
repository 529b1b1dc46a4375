// The object under the pointer where the mesh is shown. The triangle there has a class. The object is the one of that
// class whose splats are nearest (as src/edit/export/object_meshes.h).
import { type PlyMesh } from './mesh_ply';
import { MeshRays } from './mesh_rays';
import { type Hit, type Splats } from './pick';
import { kSolid } from './splat_points';

const kNoLabel = 65535;

export class MeshPicker {
  private mesh: PlyMesh | null = null;
  private rays!: MeshRays;

  /// `drawn` tells whether a triangle is drawn, by the place of its first corner in the list of corners.
  pick(mesh: PlyMesh, splats: Splats | null, origin: number[], direction: number[], drawn: (corner: number) => boolean): Hit | null {
    if (this.mesh !== mesh) { this.rays = new MeshRays(mesh); this.mesh = mesh; }
    const found = this.rays.first(origin, direction, drawn);
    if (!found) return null;
    const label = labelOf(mesh, found.triangle), point = origin.map((x, k) => x + found.distance * direction[k]);
    return { label, share: 0, instance: splats && label !== kNoLabel ? nearestObject(splats, label, point) : 0, confidence: 0, distance: found.distance };
  }
}

/// The class that two of the corners have, else that of the first.
function labelOf(mesh: PlyMesh, triangle: number): number {
  if (!mesh.labels) return kNoLabel;
  const [a, b, c] = [0, 1, 2].map((k) => mesh.labels![mesh.indices[triangle + k]]);
  return b === c ? b : a;
}

function nearestObject(s: Splats, label: number, [x, y, z]: number[]): number {
  if (!s.labels || !s.instances) return 0;
  let best = Infinity, instance = 0;
  for (let i = 0; i < s.count; ++i) {
    if (s.labels[i] !== label || s.instances[i] === 0 || s.opacities[i] < kSolid) continue;
    const d = (s.centres[3 * i] - x) ** 2 + (s.centres[3 * i + 1] - y) ** 2 + (s.centres[3 * i + 2] - z) ** 2;
    if (d < best) { best = d; instance = s.instances[i]; }
  }
  return instance;
}
