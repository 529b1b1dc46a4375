// Processor time of the browser: it counts where other work makes the clock's meaningless.
import { readdirSync, readFileSync } from 'node:fs';

const kTicks = 100; // a second, of the kernel's counters

/// Seconds that the processes which this one has begun have taken so far; `without`: process ids that do not count.
export function processorSeconds(without = []) {
  const parents = new Map(), used = new Map(), left = new Set(without.map(String));
  for (const pid of readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/^.*\) /, '').split(' '); // from the state on
      parents.set(pid, fields[1]);
      used.set(pid, (Number(fields[11]) + Number(fields[12])) / kTicks);
    } catch { /* it has ended */ }
  }
  const ours = (pid) => !left.has(pid) && pid !== undefined && (parents.get(pid) === String(process.pid) || ours(parents.get(pid)));
  return [...used].reduce((sum, [pid, seconds]) => sum + (ours(pid) ? seconds : 0), 0);
}

export const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
