// The keys of the page and their actions.
import { kExported } from './api';
import { element } from './dom';
import { showKeys, type Key } from './keys';
import { type Page } from './page';

export function pageKeys(page: Page): Key[] {
  const keys: Key[] = [
    { keys: ['1', '2'], shown: '1, 2', does: 'splats, mesh', here: () => !!page.state.mesh, action: (key) => page.showMode(key === '1' ? 'splats' : 'mesh') },
    { keys: ['w', 'a', 's', 'd', 'q', 'e'], shown: 'w a s d q e', does: 'move', action: (key) => void page.navigation.press(key) },
    { keys: ['ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight', 'Enter'], shown: 'arrows, Enter', does: 'draw the selection: move the mark, set a corner',
      here: () => page.hand.drawing, action: (key) => page.hand.key(key) },
    { keys: ['ArrowUp', 'ArrowDown', 'ArrowLeft', 'ArrowRight'], shown: 'arrows', does: 'forward, back, turn', here: () => !page.hand.drawing, action: (key) => void page.navigation.press(key) },
    { keys: [], shown: 'drag, shift + arrows', does: 'move the picked object over the floor', here: () => !!page.selection.name, action: () => {} },
    { keys: ['g'], shown: 'g', does: 'walk through the room, or turn it', action: () => page.places.setMode(page.navigation.mode === 'walk' ? 'orbit' : 'walk') },
    { keys: ['h'], shown: 'h', does: 'start pose', action: () => page.places.start() },
    { keys: ['f'], shown: 'f', does: 'floor plan', here: () => !!page.state.room, action: () => page.togglePlan() },
    { keys: ['l'], shown: 'l', does: 'label colours on or off', here: () => !!page.viewer.splats?.labels,
      action: () => page.overlay(Number(element<HTMLInputElement>('overlay').value) > 0 ? 0 : 70) },
    { keys: ['c'], shown: 'c', does: 'cameras', here: () => (page.state.cameras ?? []).length > 0, action: () => page.toggleFrusta() },
    { keys: ['b'], shown: 'b', does: 'select by hand', here: () => page.state.editable, action: () => page.hand.toggle() },
    { keys: ['m'], shown: 'm', does: 'measure', action: () => page.measures.toggle() },
    { keys: ['k'], shown: 'k', does: 'add the view to the camera path', action: () => page.path.add() },
    { keys: ['n', 'p'], shown: 'n, p', does: 'next, previous photo', here: () => !kExported && (page.state.cameras ?? []).length > 0,
      action: (key) => page.comparison.next(key === 'n' ? 1 : -1) },
    { keys: ['/'], shown: '/', does: 'type an edit', here: () => page.state.editable, action: () => { page.openPanel(true); element('edit-text').focus(); } },
    { keys: ['z', 'y'], shown: 'z, y', does: 'undo, redo', here: () => page.state.editable, action: (key) => void (key === 'z' ? page.edits.undo() : page.edits.redo()) },
    { keys: ['o'], shown: 'o', does: 'before the edits', here: () => page.state.edited, action: () => page.toggleOriginal() },
    { keys: [' '], shown: 'Space', does: 'pause the training, go on', here: () => page.state.active, action: () => void page.training.togglePause() },
    { keys: ['?'], shown: '?', does: 'this list', action: () => showKeys(keys) },
    { keys: ['Escape'], shown: 'Esc', does: 'leave', action: () => page.escape() },
  ];
  return keys;
}
