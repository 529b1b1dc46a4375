// Saved views and measurements of a run, in the scene's own axes and units. The server keeps them in
// page.json (src/serve/page_notes.h). A page without a run folder keeps them in this browser.
import { kExported, post, type RunState } from './api';

export interface SavedView { name: string; eye: number[]; target: number[]; cut?: number[] }
export interface Measurement { from: number[]; to: number[] }
export interface Notes { format: string; version: number; views: SavedView[]; measurements: Measurement[] }

export const kMostNotes = 200; // of each list, as the server has it
const empty = (): Notes => ({ format: 'aligngs page', version: 1, views: [], measurements: [] });

export class NoteKeeper {
  notes = empty();
  private store = '';   // key in this browser; empty: the server keeps them
  private sending = 0;

  /// `changed`: other notes are to be shown. `told`: something went wrong.
  constructor(private changed: () => void, private told: (error: unknown) => void) {}

  /// The notes of a run.
  open(state: RunState): void {
    const local = kExported || state.status === 'file', store = local ? `aligngs-notes:${state.name}:${kExported ? state.version : ''}` : '';
    if (local && store === this.store) return;
    if (!local && this.sending > 0) return; // what is on its way is newer
    this.store = store;
    this.notes = (local && this.stored()) || { ...empty(), ...(state.notes ?? {}) };
    this.changed();
  }

  /// Keeps changed notes.
  set(change: Partial<Pick<Notes, 'views' | 'measurements'>>): void {
    this.notes = { ...this.notes, ...change };
    this.changed();
    if (this.store) {
      try { localStorage.setItem(this.store, JSON.stringify(this.notes)); } catch { this.told(new Error('This browser keeps nothing for this page.')); }
      return;
    }
    ++this.sending;
    post('/api/notes', this.notes).catch((e) => this.told(e)).finally(() => { --this.sending; });
  }

  private stored(): Notes | null {
    try {
      const notes = JSON.parse(localStorage.getItem(this.store) ?? 'null') as Notes | null;
      return notes && Array.isArray(notes.views) && Array.isArray(notes.measurements) ? notes : null;
    } catch { return null; }
  }
}
