// Whether the server answers, and what it does.
import { type RunState } from './api';
import { element } from './dom';

const statusOf = (s: RunState): string => [s.status, s.active && s.stage && s.stage !== s.status ? s.stage : ''].filter(Boolean).join(', ');

export const tellStatus = (state: RunState): void => { element('status').textContent = statusOf(state); };

/// Without its server the page still shows the room; what needs the server waits.
export function tellConnected(connected: boolean, state: RunState): void {
  document.body.classList.toggle('offline', !connected);
  element('offline').hidden = connected;
  element('status').textContent = connected ? statusOf(state) : 'no connection';
}
