// Edits by name: the text box, the buttons of a clicked object, undo and redo, exports.
import { fetchEdits, fileUrl, kExported, post, type EditList, type EditReport, type RunState } from './api';
import { element } from './dom';
import { askHtmlExport } from './export_dialog';
import { type MessageAction, type Messages } from './messages';


export class EditPanel {
  private list: EditList = { edits: [], redo: [], formats: [], objects: [] };
  private asked = ''; // version of the run whose list is shown
  private busy = false;

  /// `changed` is called when the server has other splats to show.
  constructor(private messages: Messages, private changed: () => Promise<void>) {
    const text = element<HTMLInputElement>('edit-text');
    element('edit-form').addEventListener('submit', (e) => { e.preventDefault(); void this.apply(text.value); });
    element('edit-preview').addEventListener('click', () => void this.preview(text.value));
    element('undo').addEventListener('click', () => void this.undo());
    element('redo').addEventListener('click', () => void this.redo());
    element('export').addEventListener('click', () => void this.download(element<HTMLSelectElement>('export-format').value));
    element('preview-close').addEventListener('click', () => this.closePreview());
    element('preview-apply').addEventListener('click', () => { const edit = text.value; this.closePreview(); void this.apply(edit); });
  }

  /// Shows the panel where the run can be edited. The server is asked only when something changed.
  async refresh(state: RunState): Promise<void> {
    element('editing').hidden = !state.editable;
    this.tellWhyNot(state);
    if (!state.editable) { this.asked = ''; return; }
    const now = `${state.version} ${state.edits}`;
    if (this.asked === now || this.busy) return;
    this.asked = now;
    try { this.show(await fetchEdits()); } catch (e) { this.asked = ''; this.messages.error(e); }
  }

  /// A run that cannot be edited tells why, and gives the files that it has.
  private tellWhyNot(state: RunState): void {
    const told = kExported || state.active ? null : state.not_editable;
    element('not-editable').hidden = !told;
    element('why-not-editable').textContent = told ? `${told[0].toUpperCase()}${told.slice(1)}.` : '';
    const files = [state.splats, state.mesh].filter((f): f is string => !!f);
    element('plain-files').replaceChildren(...files.map((file) => {
      const link = document.createElement('a');
      link.href = fileUrl(file, state.version);
      link.download = file.replace(/.*\//, '');
      link.textContent = link.download;
      return link;
    }));
  }

  get objects(): EditList['objects'] { return this.list.objects; }

  /// "pillow#2" of a class number and an object number of the picture.
  objectName(label: number, instance: number): string | null {
    return this.list.objects.find((o) => o.class_id === label && o.instance === instance)?.object ?? null;
  }

  async apply(edit: string): Promise<void> {
    await this.work(`${edit} ...`, async () => {
      const answer = await post<EditList>('/api/edits/push', { edit });
      element<HTMLInputElement>('edit-text').value = '';
      if (!answer.report) return { answer, told: `undone: ${answer.undone}` };
      return { answer, told: summary(answer.report), action: this.askForContents(answer.report) };
    });
  }
  /// Asks whether what was left behind goes along: the edit is made again with it.
  private askForContents(report: EditReport): MessageAction | undefined {
    if (report.left_behind.length === 0 || report.edit.startsWith('replace ')) return undefined; // that names a source of the server
    return { label: 'take along', run: () => void this.takeAlong(report.edit) };
  }
  private async takeAlong(edit: string): Promise<void> {
    await this.work(`${edit}, with contents ...`, async () => {
      if (this.list.edits[this.list.edits.length - 1] !== edit) throw new Error('Another edit was made since. Say "with contents" in a new one.');
      await post<EditList>('/api/edits/undo', {});
      this.asked = ''; // the list is asked for again if the next request fails
      const answer = await post<EditList>('/api/edits/push', { edit: edit.replace(/^\S+/, '$& --with-contents') });
      return { answer, told: summary(answer.report!) };
    });
  }
  async undo(): Promise<void> {
    if (this.list.edits.length === 0) return;
    await this.work('undo ...', async () => {
      const answer = await post<EditList>('/api/edits/undo', {});
      return { answer, told: `undone: ${answer.undone}` };
    });
  }
  async redo(): Promise<void> {
    if (this.list.redo.length === 0) return;
    await this.work('redo ...', async () => {
      const answer = await post<EditList>('/api/edits/redo', {});
      return { answer, told: summary(answer.report!) };
    });
  }

  async preview(edit: string): Promise<void> {
    await this.work(`looking at what "${edit}" would do ...`, async () => {
      const report = await post<EditReport>('/api/edits/preview', { edit });
      element<HTMLImageElement>('preview-picture').src = report.picture ?? '';
      element('preview-text').textContent = `${summary(report)}; view ${report.view}; nothing is changed yet`;
      element<HTMLDialogElement>('preview').showModal();
      return { told: '' };
    });
  }
  closePreview(): void { element<HTMLDialogElement>('preview').close(); }

  async download(format: string): Promise<void> {
    let without: string | null = '';
    if (format === 'html') {
      try { without = await askHtmlExport(); } catch (e) { this.messages.error(e); return; }
    }
    if (without === null) return;
    await this.work(`writing ${format} ...`, async () => {
      const { file, bytes } = await post<{ file: string; bytes: number }>('/api/export', format === 'html' ? { format, without } : { format });
      const link = document.createElement('a');
      link.href = fileUrl(file, String(Date.now()));
      link.download = file;
      link.click();
      return { told: `${file}, ${(bytes / 1e6).toFixed(2)} MB, is in the run folder` };
    });
  }

  private async work(doing: string, action: () => Promise<{ answer?: EditList; told: string; action?: MessageAction }>): Promise<void> {
    if (this.busy) return;
    this.setBusy(true);
    this.messages.show(doing, 'work');
    try {
      const done = await action();
      if (done.answer) { this.show(done.answer); await this.changed(); }
      this.messages.show(done.told, done.action ? 'result' : 'note', done.action);
    } catch (e) {
      this.messages.error(e);
    } finally {
      this.setBusy(false);
    }
  }

  private setBusy(busy: boolean): void {
    this.busy = busy;
    document.body.classList.toggle('busy', busy);
    for (const button of document.querySelectorAll<HTMLButtonElement>('#editing button, #picked button')) button.disabled = busy;
    if (!busy) this.enable();
  }

  private enable(): void {
    element<HTMLButtonElement>('undo').disabled = this.list.edits.length === 0;
    element<HTMLButtonElement>('redo').disabled = this.list.redo.length === 0;
  }

  private show(list: EditList): void {
    this.list = list;
    const rows = list.edits.map((text) => {
      const row = document.createElement('li');
      row.textContent = text;
      return row;
    });
    element('edits').replaceChildren(...rows);
    element('edits').hidden = rows.length === 0;
    element('redo').title = list.redo.length ? `again: ${list.redo[0]} (y)` : 'nothing was undone (y)';
    const names = [...new Set(list.objects.map((o) => o.object.replace(/#.*/, '')))];
    element('object-names').replaceChildren(...['delete', 'extract', 'highlight'].flatMap((verb) => names.map((n) => new Option(`${verb} ${n}`))));
    const formats = element<HTMLSelectElement>('export-format'), before = formats.value;
    formats.replaceChildren(...list.formats.map((f) => new Option(f, f)));
    formats.value = list.formats.includes(before) ? before : 'glb';
    this.enable();
  }
}

function summary(r: EditReport): string {
  const objects = r.objects.map((o) => o.object).join(', ');
  const absent = r.absent.length ? `; the room has no ${r.absent.join(', ')}` : '';
  const left = r.left_behind.length ? `; left behind: ${r.left_behind.join(', ')}` : '';
  const warnings = r.warnings.map((text) => `; warning: ${text}`).join('');
  const counts = `${r.selected_gaussians.toLocaleString('en')} of ${r.gaussians_before.toLocaleString('en')} Gaussians`;
  return `${r.edit}: ${objects}, ${counts}${r.filled_gaussians ? `, ${r.filled_gaussians.toLocaleString('en')} new ones close the hole` : ''}${left}${absent}${warnings}`;
}
