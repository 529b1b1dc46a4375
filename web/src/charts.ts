// Loss and PSNR of the training, live.
import uPlot from 'uplot';
import { type TrainEvent } from './api';

const kMaxPoints = 1200; // per chart: more than its pixels

export class Charts {
  private steps: number[] = [];
  private loss: number[] = [];
  private psnr: number[] = [];
  private plots: { plot: uPlot; values: () => number[] }[] = [];
  private pending = 0;

  constructor(private element: HTMLElement) {
    const chart = (title: string, color: string, values: () => number[]) => {
      const color_of = (name: string) => () => getComputedStyle(document.documentElement).getPropertyValue(name);
      const axis = { stroke: color_of('--dim'), grid: { stroke: color_of('--line') }, ticks: { stroke: color_of('--line') }, size: 38, font: '10px system-ui' };
      const plot = new uPlot({
        width: this.width(), height: 120, title, legend: { show: false }, cursor: { y: false },
        scales: { x: { time: false } }, axes: [{ ...axis, size: 26 }, axis], series: [{}, { stroke: color, width: 1.5, points: { show: false } }],
      }, [[], []], element);
      this.plots.push({ plot, values });
    };
    chart('loss', '#ffb454', () => this.loss);
    chart('PSNR of the training view, dB', '#59c2ff', () => this.psnr);
    new ResizeObserver(() => { for (const { plot } of this.plots) plot.setSize({ width: this.width(), height: 120 }); }).observe(element);
  }

  reset(): void { this.steps = []; this.loss = []; this.psnr = []; this.update(); }

  add(events: TrainEvent[]): void {
    for (const e of events) {
      if (!e.losses || e.psnr === undefined) continue;
      this.steps.push(e.step);
      this.loss.push(e.losses.total);
      this.psnr.push(e.psnr);
    }
    this.update();
  }

  /// Draws with the colours of another theme.
  recolor(): void { if (this.points > 0) this.update(); }

  get points(): number { return this.steps.length; }

  private width(): number { return Math.max(160, this.element.clientWidth - 4); }

  private update(): void {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      for (const { plot, values } of this.plots) plot.setData(means(this.steps, values()));
    });
  }
}

/// Means over equal runs of points: single training views jump up and down.
function means(x: number[], y: number[]): [number[], number[]] {
  const run = Math.max(1, Math.ceil(x.length / kMaxPoints), x.length > 60 ? 5 : 1);
  const outX: number[] = [], outY: number[] = [];
  for (let i = 0; i < x.length; i += run) {
    const part = y.slice(i, i + run);
    outX.push(x[Math.min(x.length - 1, i + (run >> 1))]);
    outY.push(part.reduce((a, b) => a + b, 0) / part.length);
  }
  return [outX, outY];
}
