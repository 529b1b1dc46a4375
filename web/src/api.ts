// The server's description of a run (src/serve/served_run.h), the stream of its events, and the page's requests. In an
// exported page (src/serve/html_export.h) the scene is in the file and there is no server.
import { unpackScene } from './packed_scene';

export interface ClassInfo { id: number; name: string; synonyms: string[]; color: [number, number, number]; gaussians?: number }
export interface CameraInfo {
  img_name: string; width: number; height: number;
  position: [number, number, number]; rotation: number[][]; // camera to world, OpenCV axes
  fx: number; fy: number; cx?: number; cy?: number; split?: string;
}
export interface Stage { name: string; state: 'done' | 'now' | 'waiting' }
export interface RunState {
  name: string; status: string | null; stage: string | null; stages: Stage[]; version: string;
  active: boolean; editable: boolean; edited: boolean;
  splats: string | null; original: string | null; mesh: string | null; up: [number, number, number] | null; units: string | null;
  classes: ClassInfo[] | null; cameras: CameraInfo[] | null;
  views: Record<string, { split: string; kinds: string[] }>;
  train: { iterations?: number; gaussians?: number; seconds?: number } | null;
  report: boolean;
}
export interface TrainEvent { step: number; event?: string; losses?: Record<string, number>; psnr?: number; gaussians?: number; seconds_per_step?: number }
export interface EditList {
  edits: string[]; redo: string[]; formats: string[];
  objects: { object: string; class_id: number; instance: number; gaussians: number }[];
  report?: EditReport; undone?: string;
}
export interface EditReport {
  edit: string; objects: { object: string; gaussians: number }[]; selected_gaussians: number; gaussians_before: number;
  gaussians_after: number; filled_gaussians: number; picture?: string | null; view?: string;
}

const embedded = document.getElementById('aligngs-scene');
/// Whether the page came from a file, without a server.
export const kExported = embedded !== null;
let exportedSplats = ''; // blob URL

export const fileUrl = (path: string, version = ''): string =>
  kExported ? exportedSplats : '/files/' + path.split('/').map(encodeURIComponent).join('/') + (version ? '?v=' + encodeURIComponent(version) : '');
export const photoUrl = (view: string): string => '/api/photo/' + encodeURIComponent(view);
export const renderUrl = (view: string, kind: string): string => `/api/render/${encodeURIComponent(view)}/${kind}.png`;

export async function fetchState(): Promise<RunState> {
  if (embedded) {
    const { state, ply } = await unpackScene(embedded.textContent!.trim());
    if (!exportedSplats) exportedSplats = URL.createObjectURL(new Blob([ply]));
    return { stage: null, stages: [], active: false, editable: false, edited: false, original: null, mesh: null, views: {}, train: null, report: false, ...(state as Partial<RunState>) } as RunState;
  }
  return answered(await fetch('/api/state'));
}

/// The server's refusal, in its words.
async function answered<T>(answer: Response): Promise<T> {
  const text = await answer.text();
  if (answer.ok) return JSON.parse(text) as T;
  let told: { error?: string; remedy?: string } = {};
  try { told = JSON.parse(text); } catch { /* not ours */ }
  throw new Error(told.error ? told.error + (told.remedy ? `: ${told.remedy}` : '') : `the server answered ${answer.status}`);
}

/// The token of this server: cookies know no ports, so their name has it.
const token = (): string => new RegExp(`(?:^|; )aligngs_${location.port || '80'}=([0-9a-f]+)`).exec(document.cookie)?.[1] ?? '';

export async function post<T>(path: string, body: Record<string, string>): Promise<T> {
  return answered(await fetch(path, {
    method: 'POST', headers: { 'Content-Type': 'application/json', 'X-AlignGS-Token': token() }, body: JSON.stringify(body),
  }));
}
export const fetchEdits = async (): Promise<EditList> => answered(await fetch('/api/edits'));

/// One event stream per visible page: browsers allow six connections to a host. Starts again from the first event
/// whenever the page comes back, after `reset`.
export function listen(handlers: { reset(): void; events(events: TrainEvent[]): void; state(version: string): void; lost(): void }): void {
  if (kExported) return;
  let source: EventSource | null = null;
  const open = () => {
    handlers.reset();
    source = new EventSource('/api/events');
    source.addEventListener('events', (e) => handlers.events(JSON.parse((e as MessageEvent).data)));
    source.addEventListener('error', () => handlers.lost());
    source.addEventListener('state', (e) => handlers.state(JSON.parse((e as MessageEvent).data)));
  };
  document.addEventListener('visibilitychange', () => {
    if (document.hidden) { source?.close(); source = null; }
    else if (!source) open();
  });
  open();
}
