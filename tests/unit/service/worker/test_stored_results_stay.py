"""What is stored stays as it is, whatever a later attempt of the same computation writes."""

from service.store.files import DirectoryFiles, digest_of
from service.worker.child import _unlink_stored


def test_another_attempt_writes_beside_what_was_stored(tmp_path):
    workspace, kept = tmp_path / "work", tmp_path / "results"
    (workspace / "pieces").mkdir(parents=True)
    made, piece = workspace / "result.nc", workspace / "pieces" / "1"
    made.write_bytes(b"first attempt")
    piece.write_bytes(b"kept for the next")
    files, sha256 = DirectoryFiles(kept), digest_of(made)
    files.put("a.nc", made, sha256)  # and here the service is killed
    _unlink_stored(workspace)
    with made.open("wb") as stream:
        stream.write(b"second attempt")
    assert files.digest("a.nc") == sha256
    assert piece.read_bytes() == b"kept for the next"
