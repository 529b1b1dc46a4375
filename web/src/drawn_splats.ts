// The splats and triangles that are drawn now: not those of hidden classes and objects, nor what is cut away.
import { type Mat4 } from 'playcanvas';
import { type CutBounds } from './cut_box';
import { type PlyMesh } from './mesh_ply';
import { type Splats } from './pick';
import { type Cut } from './room_box';

/// `shell`: walls, ceiling and what hangs on them; it is cut away where it hides the room.
export interface ClassStyle { color: [number, number, number]; visible: boolean; shell?: boolean }

export const objectKey = (label: number, instance: number): string => `${label}#${instance}`;

export class DrawnSplats {
  styles: ClassStyle[] = [];
  hiddenObjects = new Set<string>();
  cuts: Cut[] = [];    // sides of the room that are in the way
  wall = 1;            // how thick a wall is, scene units
  box: CutBounds | null = null; // what is outside is cut away
  private turn = new Float32Array(16); // from the scene's axes to the y-up world

  setTurn(world: Mat4): void { this.turn = new Float32Array(world.data); }
  style(label: number): ClassStyle { return this.styles[label] ?? { color: [128, 128, 128], visible: true }; }

  /// Whether splat i of a scene is drawn; as the shader of splat_layer.ts has it, with half of the light as the limit.
  has(s: Splats, i: number): boolean {
    if (this.box && !this.isInBox(s.centres, i)) return false;
    if (!s.labels) return true;
    const style = this.style(s.labels[i]);
    if (!style.visible) return false;
    if (this.hiddenObjects.size > 0 && this.hiddenObjects.has(objectKey(s.labels[i], s.instances ? s.instances[i] : 0))) return false;
    return this.cuts.length === 0 || this.isBefore(s.centres[3 * i], s.centres[3 * i + 1], s.centres[3 * i + 2], !!style.shell);
  }

  /// Whether a triangle is drawn, by the place of its first corner in the list of corners.
  hasTriangle(mesh: PlyMesh, corner: number): boolean {
    if (this.box) for (let k = 0; k < 3; ++k) if (!this.isInBox(mesh.positions, mesh.indices[corner + k])) return false;
    return !mesh.labels || this.style(mesh.labels[mesh.indices[corner]]).visible;
  }

  private isInBox(places: Float32Array, i: number): boolean {
    const m = this.turn, { axes, low, high } = this.box!, x = places[3 * i], y = places[3 * i + 1], z = places[3 * i + 2];
    const wx = m[0] * x + m[4] * y + m[8] * z, wy = m[1] * x + m[5] * y + m[9] * z, wz = m[2] * x + m[6] * y + m[10] * z;
    for (let k = 0; k < 3; ++k) {
      const at = axes[k].x * wx + axes[k].y * wy + axes[k].z * wz;
      if (at < low[k] || at > high[k]) return false;
    }
    return true;
  }

  private isBefore(x: number, y: number, z: number, shell: boolean): boolean {
    const m = this.turn, wx = m[0] * x + m[4] * y + m[8] * z, wy = m[1] * x + m[5] * y + m[9] * z, wz = m[2] * x + m[6] * y + m[10] * z;
    return this.cuts.every(({ normal, offset }) => normal.x * wx + normal.y * wy + normal.z * wz - offset < (shell ? 0.5 : 2.5) * this.wall);
  }
}
