// What the server says of a run (src/serve/served_run.h) and the stream of its events.
export interface ClassInfo { id: number; name: string; synonyms: string[]; color: [number, number, number]; gaussians?: number }
export interface CameraInfo {
  img_name: string; width: number; height: number;
  position: [number, number, number]; rotation: number[][]; // camera to world, OpenCV axes
  fx: number; fy: number; cx?: number; cy?: number; split?: string;
}
export interface RunState {
  name: string; status: string | null; stage: string | null; version: string;
  splats: string | null; mesh: string | null; up: [number, number, number] | null; units: string | null;
  classes: ClassInfo[] | null; cameras: CameraInfo[] | null;
  views: Record<string, { split: string; kinds: string[] }>;
  train: { iterations?: number; gaussians?: number; seconds?: number } | null;
  report: boolean;
}
export interface TrainEvent { step: number; event?: string; losses?: Record<string, number>; psnr?: number; gaussians?: number; seconds_per_step?: number }

export const fileUrl = (path: string, version = ''): string =>
  '/files/' + path.split('/').map(encodeURIComponent).join('/') + (version ? '?v=' + encodeURIComponent(version) : '');
export const photoUrl = (view: string): string => '/api/photo/' + encodeURIComponent(view);

export async function fetchState(): Promise<RunState> {
  const answer = await fetch('/api/state');
  if (!answer.ok) throw new Error(`the server answered ${answer.status}`);
  return answer.json();
}

/// One event stream per visible page: browsers allow six connections to a host. Starts again from the first event
/// whenever the page comes back, after `reset`.
export function listen(handlers: { reset(): void; events(events: TrainEvent[]): void; state(version: string): void }): void {
  let source: EventSource | null = null;
  const open = () => {
    handlers.reset();
    source = new EventSource('/api/events');
    source.addEventListener('events', (e) => handlers.events(JSON.parse((e as MessageEvent).data)));
    source.addEventListener('state', (e) => handlers.state(JSON.parse((e as MessageEvent).data)));
  };
  document.addEventListener('visibilitychange', () => {
    if (document.hidden) { source?.close(); source = null; }
    else if (!source) open();
  });
  open();
}
