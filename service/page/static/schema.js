/** What a JSON schema says of the fields below it, and the values that they have in a case. */

/** The schema behind references and "or nothing". */
export function resolved(schema, root) {
  let found = schema;
  let nullable = false;
  for (;;) {
    if (found.$ref) {
      const { $ref, ...rest } = found;
      found = { ...root.$defs[$ref.split("/").pop()], ...rest };
    } else if (found.anyOf) {
      nullable = found.anyOf.some((one) => one.type === "null");
      const { anyOf, ...rest } = found;
      found = { ...anyOf.find((one) => one.type !== "null"), ...rest };
    } else {
      return { schema: found, nullable };
    }
  }
}

/** All fields below a schema, in its order, as {path, schema, nullable, required}: required ones have no case without them. */
export function leaves(given, root, path = [], required = true) {
  const { schema, nullable } = resolved(given, root);
  if (schema.type === "object" && schema.properties) {
    const needed = new Set(required ? schema.required : []);
    return Object.entries(schema.properties).flatMap(
      ([name, inner]) => leaves(inner, root, [...path, name], needed.has(name)),
    );
  }
  return [{ path, schema: { ...schema, ...columnsOf(schema.items, root) }, nullable, required }];
}

/** The numbers of the tables that a list holds, by name. */
function columnsOf(items, root) {
  const { properties } = items ? resolved(items, root).schema : {};
  if (!properties) return {};
  const plain = Object.entries(properties).map(([name, inner]) => [name, resolved(inner, root).schema]);
  return { columns: Object.fromEntries(plain.filter(([, { type }]) => NUMBERS.includes(type))) };
}

const NUMBERS = ["integer", "number"];
const SENTENCE = 100; // characters of a text that may have commas and spaces: longer than a name

export function kindOf(schema) {
  if (schema.enum) return "choice";
  if (schema.type === "boolean") return "switch";
  if (schema.type === "string") return "text";
  if (NUMBERS.includes(schema.type)) return "number";
  if (schema.type === "array" && schema.items?.maxLength >= SENTENCE) return "sentences";
  if (schema.type === "array" && [...NUMBERS, "string"].includes(schema.items?.type)) return "list";
  if (schema.columns) return "rows";
  return "json";
}

/** Whether a field of a gear is of its flanks: a figure declared to act along them, or their grid. */
export function ofFlank(name, schema) {
  return Boolean(schema["x-along"]?.length) || /^flank_grid/.test(name);
}

export function at(content, path) {
  return path.reduce((inner, name) => (inner === null || inner === undefined ? undefined : inner[name]), content);
}

export function put(content, path, value) {
  const last = path.length - 1;
  path.slice(0, last).reduce((inner, name) => (inner[name] ??= {}), content)[path[last]] = value;
}

/** A table with another value at a path, undefined: with none; what is not on the path is shared. */
export function changed(content, [name, ...rest], value) {
  const copy = Array.isArray(content) ? [...content] : { ...content };
  if (rest.length) copy[name] = changed(content[name] ?? {}, rest, value);
  else if (value === undefined) delete copy[name];
  else copy[name] = value;
  return copy;
}

/** The case of a pair by itself, at any load: its outline depends on nothing else. */
export const pairAlone = ({ pair }) => ({ pair, load: { torque_n_m: [1] } });

export const same = (one, other) => JSON.stringify(one) === JSON.stringify(other);
