# In Python: normals.py is README's program.
python3 -m venv venv
venv/bin/pip install "$clone/bindings/python[files]"
venv/bin/python normals.py ball.png normals.f32
