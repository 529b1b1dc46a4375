// The current work: stages, progress, charts, and the buttons that pause, save and stop.
import { post, type RunState, type TrainEvent } from './api';
import { Charts } from './charts';

const element = <T extends HTMLElement>(id: string): T => document.getElementById(id) as T;

export class TrainingPanel {
  readonly charts = new Charts(element('charts'));
  private state: RunState | null = null;

  constructor(private message: (text: string) => void) {
    const on = (id: string, action: () => string, told: string) => element(id).addEventListener('click', () => void this.control(action(), told));
    on('pause', () => (this.state?.status === 'paused' ? 'resume' : 'pause'), '');
    on('checkpoint', () => 'checkpoint', 'a checkpoint is being written');
    on('stop', () => 'stop', 'stopping: a checkpoint is being written; `--resume` goes on from it');
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
    for (const id of ['pause', 'checkpoint']) element<HTMLButtonElement>(id).disabled = state.stage !== 'train';
    this.update();
  }

  async togglePause(): Promise<void> {
    if (this.state?.active && this.state.stage === 'train') await this.control(this.state.status === 'paused' ? 'resume' : 'pause', '');
  }

  private async control(action: string, told: string): Promise<void> {
    try {
      await post('/api/control', { action });
      this.message(told);
    } catch (e) {
      this.message(e instanceof Error ? e.message : String(e));
    }
  }

  private update(): void { element('training').hidden = this.charts.points === 0 && !this.state?.active; }
}
