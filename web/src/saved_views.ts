// Views of the room that are kept: with the run by name, and in a link.
import { Vec3 } from 'playcanvas';
import { cutText, type CutBox, type CutShares } from './cut_box';
import { element, iconButton, kIcons, make } from './dom';
import { type Pose } from './navigation';
import { kMostNotes, type NoteKeeper } from './notes';
import { type Viewer } from './viewer';

const kDigits = 3;       // of a coordinate in a link: millimetres
const kSavedDigits = 4;  // of a kept coordinate

const numbers = (v: Vec3): number[] => [v.x, v.y, v.z].map((x) => Number(x.toFixed(kDigits)));

/// "eye=1.2,0.3,-2&target=0,1,0", behind the # of an address.
export const poseText = (pose: Pose): string => `eye=${numbers(pose.eye).join(',')}&target=${numbers(pose.target).join(',')}`;

/// The pose of an address; null when it has none that is whole.
export function poseOf(hash: string): Pose | null {
  const fields = new URLSearchParams(hash.replace(/^#/, ''));
  const point = (name: string) => {
    const values = (fields.get(name) ?? '').split(',').map(Number);
    return values.length === 3 && fields.get(name) !== '' && values.every(Number.isFinite) ? new Vec3(...(values as [number, number, number])) : null;
  };
  const eye = point('eye'), target = point('target');
  return eye && target ? { eye, target } : null;
}

export class SavedViews {
  constructor(private viewer: Viewer, private keeper: NoteKeeper, private pose: () => Pose, private go: (pose: Pose) => void, private cut: CutBox, private told: (text: string) => void) {
    element('save-view').addEventListener('click', () => this.save());
    element('copy-link').addEventListener('click', () => void this.copy());
  }

  show(): void {
    const { views } = this.keeper.notes;
    element('views').replaceChildren(...views.map((view) => {
      const row = make('li'), open = make('button', 'class-name', view.name);
      open.addEventListener('click', () => {
        this.cut.set((view.cut as CutShares | undefined) ?? null);
        this.go({ eye: this.viewer.toWorld(view.eye), target: this.viewer.toWorld(view.target) });
      });
      row.append(open, iconButton(kIcons.bin, 'remove', 'forget', view.name, () => this.keeper.set({ views: this.keeper.notes.views.filter((v) => v !== view) })));
      return row;
    }));
  }

  private save(): void {
    const { views } = this.keeper.notes;
    if (views.length >= kMostNotes) { this.told(`There are ${kMostNotes} views. Forget some first.`); return; }
    const { eye, target } = this.pose(), place = (p: Vec3) => this.viewer.fromWorld(p, true).map((x) => Number(x.toFixed(kSavedDigits)));
    let number = views.length + 1;
    while (views.some((v) => v.name === `view ${number}`)) ++number;
    const cut = this.cut.get();
    this.keeper.set({ views: [...views, { name: `view ${number}`, eye: place(eye), target: place(target), ...(cut ? { cut } : {}) }] });
  }

  private async copy(): Promise<void> {
    const parts = [poseText(this.pose()), cutText(this.cut.get())].filter(Boolean), link = `${location.href.replace(/#.*/, '')}#${parts.join('&')}`;
    history.replaceState(null, '', link);
    try { await navigator.clipboard.writeText(link); this.told('The link is copied. It opens this view.'); }
    catch { this.told('The address of the page is now a link to this view.'); }
  }
}
