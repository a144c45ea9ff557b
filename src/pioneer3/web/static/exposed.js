// What tests see of the page: `window.pioneer3`, frozen. Pixels are CSS pixels from the canvas' top left corner.

export function expose({ model, scene, view, connection, editor, drive, layers, errand }) {
  const toScreen = (x, y) => view.toScreen(x, y);
  Object.defineProperty(window, "pioneer3", {
    value: Object.freeze({
      toScreen,
      get state() {
        const { pose } = scene;
        const drawn = pose && Object.freeze({ ...toScreen(pose.x, pose.y), theta: pose.theta });
        return Object.freeze({
          hello: model.hello,
          robot: model.selected?.id ?? null,
          robots: [...model.robots.values()].map(({ id, name, snapshot, status }) => ({ id, name, snapshot, status })),
          snapshot: model.snapshot,
          status: model.status,
          live: model.live,
          connected: connection.open,
          roundTrip: connection.roundTrip,
          things: [...model.world.things.values()],
          clock: model.world.clock,
          selected: editor.selected,
          held: [...drive.directions],
          source: drive.source,
          pose,
          drawn,
          camera: Object.freeze({ x: view.x, y: view.y, scale: view.scale, mode: view.mode }),
          ratio: scene.ratio,
          layers: layers.all,
          places: scene.places,
          offer: errand.offer && Object.freeze({ ...errand.offer }),
          scans: [...model.robots.values()].map(({ points, scanning }) => (scanning ? points.length / 2 : 0)),
          frames: scene.frames,
          toScreen,
        });
      },
    }),
  });
}
