// Whether the splats are drawn in the order that belongs to the camera. PlayCanvas sorts in a worker, one sort at a time.
// It forgets a sort that it asks for while another one runs: the camera would rest on the order of an earlier place.
// Therefore a forgotten sort is asked for again. With each order come the splats that the view shows (splat_cull.ts).
import { type AppBase, type CameraComponent, type Layer } from 'playcanvas';
import { type CullView, type SplatCull } from './splat_cull';

/// The parts of PlayCanvas 2.23 that sort, which it does not offer to others.
interface Sorter { jobsInFlight: number; setSortParams(params: unknown, radial: boolean): void }
interface Manager {
  cpuSorter: Sorter | null; sortNeeded: boolean;
  onSorted(count: number, version: number, order: Uint32Array): void;
  renderer: { update(count: number, textureSize: number): void };
  world: { getState(version: number): { textureSize: number } | null | undefined };
}
interface Director { camerasMap: Map<unknown, { layersMap: Map<unknown, { gsplatManager: Manager | null }> }> }

export class DrawOrder {
  private manager: Manager | null = null;
  private sorter: Sorter | null = null;
  private forgotten = false;

  shown = 0; // splats that are given to the graphics unit
  private seen = ''; // the view that splats were left out for

  /// `cull`: of the splats that are drawn now; null: all are drawn.
  constructor(private app: AppBase, private cull: () => { splats: SplatCull; view: CullView } | null) {}

  /// No sort runs, and the last one was for where the camera is.
  get final(): boolean { return !!this.sorter && this.sorter.jobsInFlight === 0 && !this.forgotten; }

  /// To be called with each picture of splats: their sorter may be a new one.
  watch({ camera }: CameraComponent, layer: Layer): void {
    const director = (this.app as unknown as { renderer: { gsplatDirector: Director } }).renderer.gsplatDirector;
    this.manager = director.camerasMap.get(camera)?.layersMap.get(layer)?.gsplatManager ?? null;
    const sorter = this.manager?.cpuSorter ?? null;
    if (sorter === this.sorter) return;
    this.sorter = sorter;
    this.forgotten = false;
    if (!sorter) return;
    this.leaveOut(this.manager!);
    const sort = sorter.setSortParams.bind(sorter);
    sorter.setSortParams = (params, radial) => {
      const running = sorter.jobsInFlight;
      sort(params, radial);
      if (sorter === this.sorter) this.forgotten = sorter.jobsInFlight === running;
    };
  }

  private leaveOut(manager: Manager): void {
    const sorted = manager.onSorted.bind(manager);
    this.seen = '';
    manager.onSorted = (count, version, order) => {
      const now = this.cull(), kept = now ? now.splats.apply(order, count, now.view) : count;
      this.seen = this.viewNow();
      this.shown = kept;
      sorted(count, version, order);
      const state = manager.world.getState(version);
      if (state) manager.renderer.update(kept, state.textureSize);
    };
  }

  private viewNow(): string {
    const now = this.cull();
    return now ? Object.values(now.view).join() : 'all';
  }

  /// Asks again for a forgotten sort where none runs, and for one where the view is another; true: a picture is to be drawn.
  again(): boolean {
    if (this.sorter && this.seen !== '' && this.seen !== this.viewNow()) this.forgotten = true;
    if (!this.forgotten || !this.manager || this.sorter!.jobsInFlight > 0) return false;
    this.forgotten = false;
    this.manager.sortNeeded = true;
    return true;
  }
}
