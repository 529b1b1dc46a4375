// Views of the room that are kept: in this browser by name, and in a link.
import { Vec3 } from 'playcanvas';
import { cutText, type CutBox, type CutShares } from './cut_box';
import { element, iconButton, kIcons, make } from './dom';
import { type Pose } from './navigation';

interface Saved { name: string; eye: number[]; target: number[]; cut?: CutShares | null }

const kDigits = 3; // of a coordinate in a link: millimetres

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
  private key = '';
  private views: Saved[] = [];

  constructor(private pose: () => Pose, private go: (pose: Pose) => void, private cut: CutBox, private told: (text: string) => void) {
    element('save-view').addEventListener('click', () => this.save());
    element('copy-link').addEventListener('click', () => void this.copy());
  }

  /// The views of the run with this name.
  open(run: string): void {
    if (this.key === `aligngs-views:${run}`) return;
    this.key = `aligngs-views:${run}`;
    try { this.views = JSON.parse(localStorage.getItem(this.key) ?? '[]'); } catch { this.views = []; }
    this.show();
  }

  private save(): void {
    const { eye, target } = this.pose();
    let number = this.views.length + 1;
    while (this.views.some((v) => v.name === `view ${number}`)) ++number;
    this.views.push({ name: `view ${number}`, eye: numbers(eye), target: numbers(target), cut: this.cut.get() });
    this.keep();
  }

  private keep(): void {
    try { localStorage.setItem(this.key, JSON.stringify(this.views)); } catch { this.told('This browser keeps nothing for this page.'); }
    this.show();
  }

  private show(): void {
    element('views').replaceChildren(...this.views.map((view) => {
      const row = make('li'), open = make('button', 'class-name', view.name);
      open.addEventListener('click', () => {
        this.cut.set(view.cut ?? null);
        this.go({ eye: new Vec3(...(view.eye as [number, number, number])), target: new Vec3(...(view.target as [number, number, number])) });
      });
      row.append(open, iconButton(kIcons.bin, 'remove', 'forget', view.name, () => { this.views = this.views.filter((v) => v !== view); this.keep(); }));
      return row;
    }));
  }

  private async copy(): Promise<void> {
    const parts = [poseText(this.pose()), cutText(this.cut.get())].filter(Boolean), link = `${location.href.replace(/#.*/, '')}#${parts.join('&')}`;
    history.replaceState(null, '', link);
    try { await navigator.clipboard.writeText(link); this.told('The link is copied. It opens this view.'); }
    catch { this.told('The address of the page is now a link to this view.'); }
  }
}
