// The graphics context of the picture. The first one of a browser takes long to open, in a process of its own. It is asked
// for before the page's script is read (start.ts), and taken from there afterwards.

/// Nobody looks through a headset here: asking for one costs time. PlayCanvas gets the same attributes.
export const kContext = {
  alpha: true, depth: true, stencil: true, antialias: false, preserveDrawingBuffer: true, powerPreference: 'high-performance' as const, xrCompatible: false,
};
