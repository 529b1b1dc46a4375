// The current work: stages, progress, charts, and the buttons that pause, save and stop.
import { post, type RunState, type TrainEvent } from './api';
import { Charts } from './charts';
import { element } from './dom';
import { type Messages } from './messages';


const kTitles: Record<string, string> = { pause: 'Space', checkpoint: 'write a checkpoint now', stop: 'write a checkpoint and end' };

export class TrainingPanel {
  readonly charts = new Charts(element('charts'));
  private state: RunState | null = null;
  private wasActive: boolean | null = null;

  constructor(private messages: Messages) {
    const on = (id: string, action: () => string, told: string) => element(id).addEventListener('click', () => void this.control(action(), told));
    on('pause', () => (this.state?.status === 'paused' ? 'resume' : 'pause'), '');
    on('checkpoint', () => 'checkpoint', 'A checkpoint is being written.');
    on('stop', () => 'stop', 'The training ends with a checkpoint. `--resume` goes on from it.');
  }

  reset(): void { this.charts.reset(); }

  events(events: TrainEvent[]): void {
    this.charts.add(events);
    const last = events.filter((e) => e.losses).pop();
    if (last) {
      const rate = last.seconds_per_step ? `, ${(1 / last.seconds_per_step).toFixed(1)} steps/s` : '';
      element('progress').textContent = `step ${last.step}, ${last.gaussians?.toLocaleString('en')} Gaussians, ${last.psnr?.toFixed(2)} dB${rate}`;
    }
    this.update();
  }

  refresh(state: RunState): void {
    this.state = state;
    element('stages').replaceChildren(...state.stages.map((stage) => {
      const row = document.createElement('li');
      row.className = `stage-${stage.state}`;
      row.textContent = stage.name;
      row.title = stage.state;
      return row;
    }));
    element('pause').textContent = state.status === 'paused' ? 'go on' : 'pause';
    element('controls').hidden = !state.active;
    for (const id of ['pause', 'checkpoint', 'stop']) {
      element<HTMLButtonElement>(id).disabled = state.stage !== 'train';
      element(id).title = state.stage === 'train' ? kTitles[id] : 'This is for the training. Ctrl-C ends the other stages.';
    }
    this.place(state.active);
    this.update();
  }

  async togglePause(): Promise<void> {
    if (this.state?.active && this.state.stage === 'train') await this.control(this.state.status === 'paused' ? 'resume' : 'pause', '');
  }

  private async control(action: string, told: string): Promise<void> {
    try {
      await post('/api/control', { action });
      this.messages.show(told);
    } catch (e) {
      this.messages.error(e);
    }
  }

  /// Above the lists while something is made, closed below them afterwards.
  private place(active: boolean): void {
    if (this.wasActive === active) return;
    this.wasActive = active;
    const box = element<HTMLDetailsElement>('training');
    box.open = active;
    if (active) element('lists').before(box);
    else element('lists').after(box);
  }

  private update(): void { element('training').hidden = this.charts.points === 0 && !this.state?.active; }
}
