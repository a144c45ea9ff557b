// Requests to the HTTP API.

const JSON_TYPE = { "Content-Type": "application/json" };

/** Returns the answer, or null for an empty one. Throws an Error with the reason in words. */
export async function ask(method, path, body) {
  const options = { method, headers: body ? JSON_TYPE : {}, body: body && JSON.stringify(body) };
  let response;
  try {
    response = await fetch(`/api/${path}`, options);
  } catch {
    throw new Error("Not connected to the driver.");
  }
  const answer = response.status === 204 ? null : await response.json();
  if (response.ok) return answer;
  throw Object.assign(new Error(answer.detail), { status: response.status });
}

/** Goes to a page that tells how to come in if this browser is not paired, or not any more. */
export async function checkPairing(path = "/pair") {
  try {
    await ask("GET", "me");
  } catch ({ status }) {
    if (status === 401) location.replace(path);
  }
}
