// For the app on a home screen: a page of its own where the driver cannot be reached. It keeps
// nothing: the page comes from the driver each time and names the version of its parts, so that no
// old page ever drives.

const NOT_CONNECTED = `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">
<meta name="color-scheme" content="dark light">
<meta http-equiv="refresh" content="5">
<title>NOT CONNECTED: pioneer3</title>
<style>
  html { height: 100%; font: 17px/1.5 system-ui, sans-serif; }
  body { box-sizing: border-box; min-height: 100%; margin: 0; padding: 24px; display: grid; place-content: center; text-align: center; }
  a { color: inherit; }
</style>
<h1>Not connected</h1>
<p>The driver cannot be reached. A robot that you drove has stopped by itself.</p>
<p>Is this device on the robot's network, and is <code>pioneer3 run</code> running?</p>
<p><a href="/">Try again</a>; this page does so every 5 seconds.</p>
</html>`;

const notConnected = () =>
  new Response(NOT_CONNECTED, {
    status: 503,
    headers: {
      "content-type": "text/html; charset=utf-8",
      "content-security-policy": "default-src 'none'; style-src 'unsafe-inline'",
    },
  });

addEventListener("install", () => self.skipWaiting());
addEventListener("fetch", (event) => {
  if (event.request.mode === "navigate") event.respondWith(fetch(event.request).catch(notConnected));
});
