// Whether the splats are drawn in the order that belongs to the camera. PlayCanvas sorts in a worker, one sort at a time.
// It forgets a sort that it asks for while another one runs: the camera would rest on the order of an earlier place.
// Therefore a forgotten sort is asked for again.
import { type AppBase, type CameraComponent, type Layer } from 'playcanvas';

/// The parts of PlayCanvas 2.23 that sort, which it does not offer to others.
interface Sorter { jobsInFlight: number; setSortParams(params: unknown, radial: boolean): void }
interface Manager { cpuSorter: Sorter | null; sortNeeded: boolean }
interface Director { camerasMap: Map<unknown, { layersMap: Map<unknown, { gsplatManager: Manager | null }> }> }

export class DrawOrder {
  private manager: Manager | null = null;
  private sorter: Sorter | null = null;
  private forgotten = false;

  constructor(private app: AppBase) {}

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
    const sort = sorter.setSortParams.bind(sorter);
    sorter.setSortParams = (params, radial) => {
      const running = sorter.jobsInFlight;
      sort(params, radial);
      if (sorter === this.sorter) this.forgotten = sorter.jobsInFlight === running;
    };
  }

  /// Asks again for a forgotten sort where none runs; true: a picture is to be drawn.
  again(): boolean {
    if (!this.forgotten || !this.manager || this.sorter!.jobsInFlight > 0) return false;
    this.forgotten = false;
    this.manager.sortNeeded = true;
    return true;
  }
}
