// A stick on the screen for walking with a thumb.
const kReach = 40; // pixels from its middle to full speed

export function joystick(stick: HTMLElement, moved: (right: number, forward: number) => void): void {
  const knob = stick.firstElementChild as HTMLElement;
  let pointer = -1;
  const set = (right: number, forward: number) => {
    knob.style.transform = `translate(${right * kReach}px, ${-forward * kReach}px)`;
    moved(right, forward);
  };
  const follow = (e: PointerEvent) => {
    if (e.pointerId !== pointer) return;
    const box = stick.getBoundingClientRect(), x = (e.clientX - box.left - box.width / 2) / kReach, y = (e.clientY - box.top - box.height / 2) / kReach;
    const length = Math.max(1, Math.hypot(x, y));
    set(x / length, -y / length);
  };
  stick.addEventListener('pointerdown', (e) => { pointer = e.pointerId; stick.setPointerCapture(pointer); follow(e); e.preventDefault(); });
  stick.addEventListener('pointermove', follow);
  for (const end of ['pointerup', 'pointercancel']) stick.addEventListener(end, () => { pointer = -1; set(0, 0); });
}
