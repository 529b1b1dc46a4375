// Buttons, sliders and the pointer of the page, and what they do.
import { element } from './dom';
import { joystick } from './joystick';
import { bindKeys, showKeys } from './keys';
import { type Page } from './page';
import { bindPickedEdits } from './picked_edits';
import { bindTheme } from './theme';

export function bindControls(page: Page): void {
  const on = (id: string, event: string, action: () => void) => element(id).addEventListener(event, action);
  on('show-splats', 'click', () => page.showMode('splats'));
  on('show-mesh', 'click', () => page.showMode('mesh'));
  on('overlay', 'input', () => page.applyStyles());
  on('measure', 'click', () => page.measures.toggle());
  on('frusta', 'click', () => page.toggleFrusta());
  on('home', 'click', () => page.places.start());
  on('walk', 'click', () => page.places.setMode(page.navigation.mode === 'walk' ? 'orbit' : 'walk'));
  on('plan-button', 'click', () => page.togglePlan());
  on('plan-close', 'click', () => page.togglePlan());
  joystick(element('stick'), (right, forward) => { page.navigation.stick = { right, forward }; page.navigation.run(); });
  page.viewer.canvas.addEventListener('pointermove', (e) => {
    if (e.pointerType === 'mouse' && e.buttons === 0 && !page.measures.active && !page.hand.drawing && !page.comparison.camera) page.selection.hover({ x: e.clientX, y: e.clientY });
    else if (e.buttons !== 0) page.selection.hover(null);
  });
  window.addEventListener('hashchange', () => page.places.followLink());
  bindTheme((dark) => { page.viewer.setBackground(dark); page.training.charts.recolor(); });
  on('original', 'click', () => page.toggleOriginal());
  bindPickedEdits(page.selection, page.edits);
  on('reload', 'click', () => location.reload());
  on('help-button', 'click', () => showKeys(page.keys));
  on('help-close', 'click', () => element<HTMLDialogElement>('help').close());
  on('panel-button', 'click', () => page.openPanel(!document.body.classList.contains('panel-open')));
  bindKeys(page.keys);
}
