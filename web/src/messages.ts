// Messages at the top of the picture: one message at a time, which goes by itself or is closed.
import { element } from './dom';

export type MessageKind =
  | 'note'    // disappears by itself
  | 'work'    // stays until another message takes its place: something goes on
  | 'result' // stays until it is closed: a measurement
  | 'error';  // stays until it is closed

/// A button of a message.
export interface MessageAction { label: string; run: () => void }

export class Messages {
  noteTime = 8000; // milliseconds: two lines are read in that time
  private timer = 0;
  private action: MessageAction | undefined;

  constructor() {
    element('message-close').addEventListener('click', () => this.clear());
    element('message-action').addEventListener('click', () => this.action?.run());
  }

  show(text: string, kind: MessageKind = 'note', action?: MessageAction): void {
    window.clearTimeout(this.timer);
    this.action = action;
    element('message-action').hidden = !action;
    element('message-action').textContent = action?.label ?? '';
    element('message').textContent = text;
    element('message-box').hidden = text === '';
    element('message-box').className = kind;
    element('message-close').hidden = kind === 'work';
    if (kind === 'note' && text) this.timer = window.setTimeout(() => this.clear(), this.noteTime);
  }
  error(error: unknown): void { this.show(error instanceof Error ? error.message : String(error), 'error'); }
  clear(): void { this.show(''); }
}
