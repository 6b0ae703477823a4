// What the reader has chosen: recording, time, models, colouring. Parts of the page subscribe to it.

export function createStore(initial) {
  const state = { ...initial };
  const listeners = [];
  return {
    get: () => state,
    set(changes) {
      const changed = Object.keys(changes).filter((key) => state[key] !== changes[key]);
      if (changed.length === 0) return;
      Object.assign(state, changes);
      for (const { keys, listener } of [...listeners]) if (keys.some((key) => changed.includes(key))) listener(state, changed);
    },
    // Returns a function that ends the subscription.
    on(keys, listener) {
      const entry = { keys, listener };
      listeners.push(entry);
      return () => { listeners.splice(listeners.indexOf(entry), 1); };
    },
  };
}
