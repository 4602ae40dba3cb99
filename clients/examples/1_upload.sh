curl -sS --fail-with-body --data-binary @tests/data/meshes/spot.ply -H 'Content-Type: model/ply' http://127.0.0.1:8080/v1/meshes
