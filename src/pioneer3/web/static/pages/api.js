// The page of the HTTP API: shows the OpenAPI document of this server.

import { byId, make } from "../dom.js";

const ref = (schema) => schema.$ref.split("/").at(-1);

/** A type in words, such as "list of number or null". */
function inWords(schema) {
  if (schema.$ref) return ref(schema);
  const either = schema.anyOf ?? schema.oneOf;
  if (either) return either.map(inWords).join(" or ");
  if (schema.type === "array") return `list of ${inWords(schema.items ?? {})}`;
  if (schema.enum) return schema.enum.map((value) => JSON.stringify(value)).join(" or ");
  const bounds = [["minimum", "≥"], ["exclusiveMinimum", ">"], ["maximum", "≤"], ["maxLength", "length ≤"]]
    .filter(([key]) => key in schema)
    .map(([key, sign]) => ` ${sign} ${schema[key]}`);
  return (schema.type ?? "anything") + bounds.join(",");
}

const content = (part) => Object.values(part?.content ?? {})[0]?.schema;

/** An example of what to send: required fields, or all where none is. */
function example(schema, schemas) {
  const known = schema.$ref ? schemas[ref(schema)] : schema;
  const one = known.anyOf ? (known.anyOf[0].$ref ? schemas[ref(known.anyOf[0])] : known.anyOf[0]) : known;
  const wanted = one.required?.length ? one.required : Object.keys(one.properties ?? {});
  return Object.fromEntries(wanted.map((name) => [name, value(one.properties[name])]));
}

function value(schema) {
  if (schema.default !== undefined) return schema.default;
  if (schema.enum) return schema.enum[0];
  return { number: 0.2, integer: 1, boolean: true, array: [] }[schema.type] ?? "";
}

function curl(method, path, body) {
  const data = body ? ` \\\n  -H 'Content-Type: application/json' -d '${JSON.stringify(body)}'` : "";
  return `curl -X ${method} ${location.origin}${path.replace("{robot}", "1")}${data}`;
}

function showOperation(path, method, operation, schemas) {
  const line = make("summary", {}, make("span", { class: "method" }, method.toUpperCase()), make("code", {}, path), what(operation.summary));
  const list = make("dl");
  const body = content(operation.requestBody);
  if (body) list.append(make("dt", {}, "Sends"), make("dd", {}, inWords(body)));
  for (const [status, answer] of Object.entries(operation.responses)) {
    const kind = content(answer);
    list.append(make("dt", {}, status), make("dd", {}, answer.description + (kind && status === "200" ? ` ${inWords(kind)}` : "")));
  }
  const command = make("pre", {}, curl(method.toUpperCase(), path, body && example(body, schemas)));
  return make("details", {}, line, make("div", { class: "more" }, make("p", {}, operation.description), list, command));
}

function showType(name, schema) {
  const list = make("dl");
  for (const [field, kind] of Object.entries(schema.properties ?? {})) {
    const optional = schema.required?.includes(field) ? "" : `, ${JSON.stringify(kind.default)} if not given`;
    list.append(make("dt", {}, field), make("dd", {}, inWords(kind) + optional));
  }
  if (schema.enum) list.append(make("dt", {}, "one of"), make("dd", {}, inWords(schema)));
  const line = make("summary", {}, make("code", {}, name), what(schema.description ?? ""));
  return make("details", {}, line, make("div", { class: "more" }, list));
}

const what = (text) => make("span", { class: "what" }, text);

const { paths, components } = await (await fetch("/api/openapi.json")).json();
let tag = "";
for (const [path, methods] of Object.entries(paths)) {
  for (const [method, operation] of Object.entries(methods)) {
    if (operation.tags[0] !== tag) {
      tag = operation.tags[0];
      byId("operations").append(make("h2", {}, tag[0].toUpperCase() + tag.slice(1)));
    }
    byId("operations").append(showOperation(path, method, operation, components.schemas));
  }
}
for (const [name, schema] of Object.entries(components.schemas)) {
  byId("types").append(showType(name, schema));
}
