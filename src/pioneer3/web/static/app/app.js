// On a home screen, and only there, a worker says when the driver cannot be reached; a browser says so itself.

const installed = matchMedia("(display-mode: standalone)").matches || navigator.standalone === true;
if (installed) navigator.serviceWorker?.register("/worker.js").catch(() => {}); // a certificate that is not trusted
