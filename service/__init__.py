"""The service around the libraries: schemas, jobs, store, HTTP, client and command line. Imports nothing."""
