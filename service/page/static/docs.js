/** The description of the API, to read and to try: Swagger UI with the access key of the page. */

import { get } from "./api.js";
import { keyHeader } from "./key.js";

const spec = await get("/openapi.json"); // asks for a key where one is needed

window.SwaggerUIBundle({
  dom_id: "#description",
  spec,
  deepLinking: true,
  defaultModelsExpandDepth: 0,
  validatorUrl: null,
  requestInterceptor(request) {
    request.headers = { ...keyHeader(), ...request.headers };
    return request;
  },
});
