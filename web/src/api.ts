// The server's description of a run (src/serve/served_run.h), the stream of its events, and the page's requests. In an
// exported page (src/serve/html_export.h) the scene is in the file and there is no server.
import { type Columns } from './columns';
import { type PlyMesh } from './mesh_ply';
import { type Notes } from './notes';
import { unpackMesh } from './packed_mesh';
import { embeddedBytes, unpackScene } from './packed_scene';

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
  edits: string | null;               // version of the edits
  selections: string | null;          // version of the selections by hand
  drawable: boolean;                  // the server draws pictures of the trained room
  splats: string | null; mesh: string | null; up: [number, number, number] | null; start: { eye: number[]; target: number[] } | null; units: string | null; units_estimated: boolean;
  classes: ClassInfo[] | null; cameras: CameraInfo[] | null;
  views: Record<string, { split: string; kinds: string[] }>;
  train: { iterations?: number; gaussians?: number; seconds?: number } | null;
  report: boolean;
  room: string | null;                // path of room.json
  room_version: string | null;
  notes: Notes | null;                // saved views and measurements
  not_editable: string | null;        // why edits, pictures and exports are not there
  problems: string[];                 // files of the run that cannot be read
}
export interface TrainEvent { step: number; event?: string; losses?: Record<string, number>; psnr?: number; gaussians?: number; seconds_per_step?: number }
export interface EditList {
  edits: string[]; redo: string[]; formats: string[];
  objects: { object: string; class_id: number; instance: number; gaussians: number; centre: [number, number, number] }[];
  report?: EditReport; undone?: string;
}
export interface EditReport {
  edit: string; objects: { object: string; gaussians: number }[]; selected_gaussians: number; gaussians_before: number;
  gaussians_after: number; filled_gaussians: number; left_behind: string[]; absent: string[]; warnings: string[]; picture?: string | null; view?: string;
}

/// Whether the page came from a file, without a server.
export const kExported = document.getElementById('aligngs-scene') !== null;

export const fileUrl = (path: string, version = ''): string =>
  '/files/' + path.split('/').map(encodeURIComponent).join('/') + (version ? '?v=' + encodeURIComponent(version) : '');
export const editedMeshUrl = (version: string): string => `/api/edits/mesh.ply?v=${encodeURIComponent(version)}`;
export const photoUrl = (view: string): string => '/api/photo/' + encodeURIComponent(view);
export const renderUrl = (view: string, kind: string): string => `/api/render/${encodeURIComponent(view)}/${kind}.png`;

let exported: { columns: Columns; room: unknown } | null = null;
/// The trained splats of an exported page, after fetchState().
export const exportedColumns = (): Columns => exported!.columns;
/// Differences that the edits of an exported page make (edited_scene.ts).
export const exportedEdits = (): Uint8Array => embeddedBytes('aligngs-edits')!;
/// The mesh of an exported page, with or before its edits.
export const exportedMesh = (before: boolean): Promise<PlyMesh> => unpackMesh(embeddedBytes(before ? 'aligngs-mesh-before' : 'aligngs-mesh') as BlobPart);

let ahead: Promise<RunState> | null = null;
/// Begins to read the state; the next fetchState() has it.
export function fetchAhead(): void {
  ahead = readState();
  ahead.catch(() => {}); // told by fetchState
}

export function fetchState(): Promise<RunState> {
  const state = ahead ?? readState();
  ahead = null;
  return state;
}

async function readState(): Promise<RunState> {
  if (kExported) {
    const { state, columns, room } = await unpackScene(embeddedBytes('aligngs-scene') as BlobPart);
    exported = { columns, room };
    return { stage: null, stages: [], active: false, editable: false, edited: false, edits: null, selections: null, drawable: false, mesh: null, views: {}, train: null, report: false, room: null, room_version: null, notes: null, start: null, not_editable: null, problems: [], ...(state as Partial<RunState>) } as RunState;
  }
  return answered(await request('/api/state'));
}

/// room.json of the run; null when it cannot be read.
/// `edited`: as the edits of the run left it.
export async function fetchRoom(path: string, version: string, edited: boolean): Promise<unknown> {
  if (kExported) return exported!.room;
  const answer = await request(edited ? `/api/edits/room.json?v=${encodeURIComponent(version)}` : fileUrl(path, version));
  return answer.ok ? answer.json() : null;
}

/// fetch() with an error that a reader understands: the browser's own is "Failed to fetch".
export async function request(url: string, init: RequestInit = {}): Promise<Response> {
  try {
    return await fetch(url, init);
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    throw new Error('The server does not answer. It has ended, or the connection is lost.');
  }
}

/// A refusal of the server, in its words.
export async function refusal(answer: Response): Promise<Error> {
  let told: { error?: string; remedy?: string } = {};
  try { told = JSON.parse(await answer.text()); } catch { /* not ours */ }
  return new Error(told.error ? told.error + (told.remedy ? `: ${told.remedy}` : '') : `The server answered ${answer.status}.`);
}
async function answered<T>(answer: Response): Promise<T> {
  if (!answer.ok) throw await refusal(answer);
  return await answer.json() as T;
}

/// The token of this server: cookies know no ports, so their name has it.
const token = (): string => new RegExp(`(?:^|; )aligngs_${location.port || '80'}=([0-9a-f]+)`).exec(document.cookie)?.[1] ?? '';

/// Fetches the page again: with it comes the token of a server that was started anew.
export async function signIn(): Promise<void> { await request('/', { cache: 'no-store' }); }

export async function post<T>(path: string, body: object): Promise<T> {
  const send = () => request(path, {
    method: 'POST', headers: { 'Content-Type': 'application/json', 'X-AlignGS-Token': token() }, body: JSON.stringify(body),
  });
  let answer = await send();
  if (answer.status === 403) { // another server than the one that this page came from
    await signIn();
    answer = await send();
  }
  return answered(answer);
}
export const fetchEdits = async (): Promise<EditList> => answered(await request('/api/edits'));

export interface Listener {
  reset(): void;                     // events come again from the first one
  events(events: TrainEvent[]): void;
  state(version: string): void;
  lost(): void;                      // the server does not answer; it is asked again every few seconds
  found(restarted: boolean): void;   // it answers (again); `restarted`: it is another one than before
}
const kAskAgain = 3000; // milliseconds after the browser has given up on a stream

/// One event stream per visible page: browsers allow six connections to a host. Starts again from the first event
/// whenever the page comes back, after `reset`.
export function listen(listener: Listener): void {
  if (kExported) return;
  let source: EventSource | null = null, server = '', again = 0;
  const open = () => {
    window.clearTimeout(again);
    listener.reset();
    source = new EventSource('/api/events');
    source.addEventListener('server', (e) => {
      const name: string = JSON.parse((e as MessageEvent).data), restarted = server !== '' && name !== server;
      server = name;
      // The new server begins with the first event, and knows nothing of the place where the old one was.
      if (restarted) { source?.close(); void signIn().then(open, () => listener.lost()).then(() => listener.found(true)); } else listener.found(false);
    });
    source.addEventListener('events', (e) => listener.events(JSON.parse((e as MessageEvent).data)));
    source.addEventListener('state', (e) => listener.state(JSON.parse((e as MessageEvent).data)));
    source.addEventListener('error', () => {
      listener.lost();
      if (source?.readyState === EventSource.CLOSED) { source = null; again = window.setTimeout(() => { if (!document.hidden && !source) open(); }, kAskAgain); }
    });
  };
  document.addEventListener('visibilitychange', () => {
    if (document.hidden) { source?.close(); source = null; window.clearTimeout(again); }
    else if (!source) open();
  });
  open();
}
