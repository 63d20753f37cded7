"""An RGB-D camera like the Kinect V2: by casting rays, which runs anywhere, or by OpenGL."""
