"""MediaPipe Pose (full) over a video: landmarks found, drawn and written, as `silpose track` writes its overlay.

usage: mediapipe_pose.py VIDEO OVERLAY.mp4
Prints {"frames": ..., "found": ...}: images read, and those with a pose.
"""
import json
import sys

import cv2
import mediapipe

pose_solution = mediapipe.solutions.pose
video = cv2.VideoCapture(sys.argv[1])
size = int(video.get(cv2.CAP_PROP_FRAME_WIDTH)), int(video.get(cv2.CAP_PROP_FRAME_HEIGHT))
overlay = cv2.VideoWriter(sys.argv[2], cv2.VideoWriter_fourcc(*"mp4v"), video.get(cv2.CAP_PROP_FPS), size)
frames = found = 0
with pose_solution.Pose(model_complexity=1) as pose:
    while True:
        is_read, image = video.read()
        if not is_read:
            break
        frames += 1
        landmarks = pose.process(cv2.cvtColor(image, cv2.COLOR_BGR2RGB)).pose_landmarks
        if landmarks:
            found += 1
            mediapipe.solutions.drawing_utils.draw_landmarks(image, landmarks, pose_solution.POSE_CONNECTIONS)
        overlay.write(image)
overlay.release()
print(json.dumps({"frames": frames, "found": found}))
