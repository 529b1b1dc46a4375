// The mesh of a run in the 3D view, in its own colours or in those of its classes.
import { type AppBase, Color, Entity, Mesh, MeshInstance, StandardMaterial } from 'playcanvas';
import { type PlyMesh } from './mesh_ply';
import { type ClassStyle } from './drawn_splats';

const kGlow = [255, 122, 5]; // linear: the colour of the glow of splats (splat_layer.ts)
const kLinear = Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * (i / 255) ** 2.2)); // sRGB to linear

export class MeshLayer {
  private entity: Entity | null = null;
  private mesh: Mesh | null = null;
  private colors = new Uint8Array();
  private marked = false;

  constructor(private app: AppBase, private parent: Entity) {}

  get shown(): boolean { return !!this.entity?.enabled; }

  show(on: boolean): void { if (this.entity) this.entity.enabled = on; }

  /// Draws a mesh instead of the one before. `mix` 0: own colours, 1: those of the classes. `keeps` tells whether a
  /// triangle is drawn, by the place of its first corner in the list of corners.
  build(ply: PlyMesh, style: (label: number) => ClassStyle, mix: number, keeps: (corner: number) => boolean): void {
    const show = !this.entity || this.entity.enabled;
    this.entity?.destroy();
    const colors = new Uint8Array(ply.colors);
    if (ply.labels) {
      for (let i = 0; i < ply.labels.length; ++i) {
        const c = style(ply.labels[i]).color;
        for (let k = 0; k < 3; ++k) colors[4 * i + k] = (1 - mix) * colors[4 * i + k] + mix * c[k];
      }
    }
    // The camera's output is converted to sRGB once more, the colours of the file are sRGB already.
    for (let i = 0; i < colors.length; ++i) if (i % 4 < 3) colors[i] = kLinear[colors[i]];
    this.colors = colors;
    this.marked = false;
    const mesh = new Mesh(this.app.graphicsDevice);
    mesh.setPositions(ply.positions);
    mesh.setColors32(colors);
    mesh.setIndices(ply.indices); // room for all of them
    mesh.update();
    const material = new StandardMaterial();
    material.useLighting = false;
    material.emissive = new Color(1, 1, 1);
    material.emissiveVertexColor = true;
    material.diffuse = new Color(0, 0, 0);
    material.cull = 0; // both sides: rooms are looked at from inside
    material.update();
    this.entity = new Entity('mesh');
    this.entity.addComponent('render', { meshInstances: [new MeshInstance(mesh, material)] });
    this.parent.addChild(this.entity);
    this.entity.enabled = show;
    this.mesh = mesh;
    this.keep(ply, keeps);
  }

  /// Lets vertices glow, one flag each; null: none.
  glow(flags: Uint8Array | null, strength: number): void {
    if (!this.mesh || (!flags && !this.marked)) return;
    this.marked = !!flags;
    const colors = new Uint8Array(this.colors);
    for (let v = 0; flags && v < flags.length; ++v) {
      for (let k = 0; flags[v] && k < 3; ++k) colors[4 * v + k] = (1 - strength) * colors[4 * v + k] + strength * kGlow[k];
    }
    this.mesh.setColors32(colors);
    this.mesh.update();
  }

  /// Draws other triangles of the same mesh.
  keep(ply: PlyMesh, keeps: (corner: number) => boolean): void {
    const kept = new Uint32Array(ply.indices.length);
    let n = 0;
    for (let f = 0; f < ply.indices.length; f += 3) {
      if (!keeps(f)) continue;
      for (let k = 0; k < 3; ++k) kept[n++] = ply.indices[f + k];
    }
    this.mesh?.setIndices(kept, n);
    this.mesh?.update();
  }
}
